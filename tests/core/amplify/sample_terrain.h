#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "core/sparse/dictionary.h"
#include "core/sparse/patches.h"
#include "core/support/random.h"
#include "core/synthesis/spectral.h"
#include "core/terrain/raster.h"
#include "core/terrain/resample.h"

namespace arete {

/// Fractal terrain (amplitude f^-beta) high above the sea, where float elevations are coarse: 0.24 mm at 3000 m.
inline Raster<float> fractal_terrain(std::int64_t width, std::int64_t height, std::uint64_t seed, double beta = 2, float lowest = 3000,
                                     double relief = 600) {
  Raster<float> cells = synthesize_spectral({width, height}, {beta, relief, seed, 2});
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] += lowest;
  return cells;
}

/// Independent elevations, uniform in [2500, 3500): the roughest input there is.
inline Raster<float> white_terrain(std::int64_t width, std::int64_t height, std::uint64_t seed) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(2500 + 1000 * uniform_at(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  return cells;
}

/// A plane over the ground, 3000 m high at the north-west corner; places in coarse cells.
struct Plane {
  double east = 7.3, south = -4.1;  // metres per coarse cell
  double at(double x, double y) const { return 3000 + east * x + south * y; }
  /// Sampled at the centres of cells 1 / factor wide.
  Raster<float> sample(std::int64_t width, std::int64_t height, int factor) const {
    Raster<float> cells(width, height);
    for (std::int64_t y = 0; y < height; ++y)
      for (std::int64_t x = 0; x < width; ++x)
        cells(x, y) = static_cast<float>(at((static_cast<double>(x) + 0.5) / factor, (static_cast<double>(y) + 0.5) / factor));
    return cells;
  }
};

inline void make_void(Raster<float>& cells, const Window& window) {
  for (std::int64_t y = window.y; y < window.y + window.height; ++y)
    for (std::int64_t x = window.x; x < window.x + window.width; ++x) cells(x, y) = void_value;
}

inline Raster<float> cut_window(RasterView<const float> from, const Window& window) {
  Raster<float> cells(window.width, window.height);
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) cells(x, y) = from(window.x + x, window.y + y);
  return cells;
}

inline bool same_bits(RasterView<const float> a, RasterView<const float> b) {
  if (a.size() != b.size()) return false;
  for (std::int64_t y = 0; y < a.height; ++y)
    if (std::memcmp(a.row(y), b.row(y), static_cast<std::size_t>(a.width) * sizeof(float)) != 0) return false;
  return true;
}

/// The largest |a - b|; infinity where one is void and the other is not.
inline double largest_difference(RasterView<const float> a, RasterView<const float> b) {
  double largest = a.size() == b.size() ? 0 : INFINITY;
  for (std::int64_t y = 0; y < a.height && largest < INFINITY; ++y)
    for (std::int64_t x = 0; x < a.width; ++x) {
      if (is_void(a(x, y)) != is_void(b(x, y))) return INFINITY;
      if (!is_void(a(x, y))) largest = std::max(largest, std::abs(static_cast<double>(a(x, y)) - static_cast<double>(b(x, y))));
    }
  return largest;
}

inline double rmse(RasterView<const float> a, RasterView<const float> b, std::int64_t border) {
  double sum = 0;
  std::int64_t cells = 0;
  for (std::int64_t y = border; y + border < a.height; ++y)
    for (std::int64_t x = border; x + border < a.width; ++x)
      if (!is_void(a(x, y)) && !is_void(b(x, y))) {
        sum += std::pow(static_cast<double>(a(x, y)) - static_cast<double>(b(x, y)), 2);
        ++cells;
      }
  return std::sqrt(sum / static_cast<double>(cells));
}

/// How far the area average of `fine` is from `coarse`, in units of the spacing of floats at the coarse cell (ulp).
inline double inconsistency_ulp(RasterView<const float> coarse, RasterView<const float> fine, int factor) {
  double largest = 0;
  for (std::int64_t y = 0; y < coarse.height; ++y)
    for (std::int64_t x = 0; x < coarse.width; ++x) {
      if (is_void(coarse(x, y))) continue;
      double sum = 0;
      for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i) sum += static_cast<double>(fine(x * factor + i, y * factor + j));
      const float z = std::abs(coarse(x, y));
      const double ulp = static_cast<double>(std::nextafter(z, INFINITY) - z);
      const double off = std::abs(sum / (factor * factor) - static_cast<double>(coarse(x, y))) / ulp;
      largest = std::isnan(off) ? INFINITY : std::max(largest, off);
    }
  return largest;
}

/// Every `keep`-th patch of an exemplar as a pair (low, high), without upsampler and detail.
inline Dictionary pair_dictionary(RasterView<const float> exemplar, int factor, const PatchGrid& grid, PatchEdges edges, int keep = 1) {
  const Raster<float> coarse = area_average(exemplar, factor);
  const Patches patches = extract_patches(coarse.view(), grid, {edges, false, true, 2});
  const int side = grid.patch_cells * factor;
  Dictionary dictionary;
  dictionary.patch_cells = grid.patch_cells;
  dictionary.factor = factor;
  dictionary.exemplars = {"exemplar"};
  const std::int64_t atoms = (patches.count() + keep - 1) / keep;
  dictionary.low.resize(grid.samples(), atoms);
  dictionary.high.resize(std::int64_t{side} * side, atoms);
  for (std::int64_t j = 0; j < atoms; ++j) {
    const std::int64_t i = j * keep;
    const PatchOrigin& origin = patches.origins[static_cast<std::size_t>(i)];
    const double norm = patches.values.col(i).cast<double>().norm();
    dictionary.low.col(j) = (patches.values.col(i).cast<double>() / norm).cast<float>();
    std::vector<float> cells(static_cast<std::size_t>(side * side));
    cut_cells(exemplar, origin.x * factor, origin.y * factor, side, 0, cells.data());
    for (std::size_t k = 0; k < cells.size(); ++k)
      dictionary.high(static_cast<Eigen::Index>(k), j) =
          static_cast<float>((static_cast<double>(cells[k]) - patches.means[static_cast<std::size_t>(i)]) / norm);
    dictionary.sources.push_back({0, origin.x, origin.y, 0});
  }
  return dictionary;
}

}  // namespace arete
