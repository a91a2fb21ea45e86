#include "core/terrain/spectrum.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <unsupported/Eigen/FFT>

#include "core/support/error.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

using Complex = std::complex<double>;

constexpr std::int64_t block_side = 8;     // of the map of voids: half of the smallest tile
constexpr std::int64_t smallest_tile = 16;
constexpr double enough_coverage = 0.5;

/// Which blocks of block_side x block_side cells, counted from the inner corner of the border, are valid in both rasters.
struct ValidBlocks {
  std::int64_t columns = 0, rows = 0;
  std::vector<bool> whole;
  std::int64_t valid_cells = 0;

  bool at(std::int64_t x, std::int64_t y) const { return whole[static_cast<std::size_t>(y * columns + x)]; }
};

/// The part inside the border.
Window inner_window(Size size, std::int64_t border) {
  return {border, border, std::max<std::int64_t>(0, size.width - 2 * border), std::max<std::int64_t>(0, size.height - 2 * border)};
}

struct BlockChunk {
  std::vector<char> whole;
  std::int64_t valid_cells = 0;
};

BlockChunk look_for_voids(const RasterSource& reference, const RasterSource& result, const Window& window) {
  Raster<float> a(window.width, window.height), b(window.width, window.height);
  reference.read(window, a.view());
  result.read(window, b.view());
  const std::int64_t columns = window.width / block_side, rows = window.height / block_side;
  BlockChunk chunk;
  chunk.whole.assign(static_cast<std::size_t>(columns * rows), 1);
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) {
      const bool valid = !is_void(a(x, y)) && !is_void(b(x, y));
      chunk.valid_cells += valid;
      const std::int64_t bx = x / block_side, by = y / block_side;
      if (!valid && bx < columns && by < rows) chunk.whole[static_cast<std::size_t>(by * columns + bx)] = 0;
    }
  return chunk;
}

ValidBlocks map_valid_blocks(const RasterSource& reference, const RasterSource& result, const Window& inner, int threads,
                             Progress& progress) {
  constexpr std::int64_t side = 512;
  ValidBlocks map;
  map.columns = inner.width / block_side;
  map.rows = inner.height / block_side;
  map.whole.assign(static_cast<std::size_t>(map.columns * map.rows), false);
  const std::int64_t across = (inner.width + side - 1) / side, chunks = across * ((inner.height + side - 1) / side);
  progress.begin("looking for voids", chunks);
  const std::int64_t together = 4 * static_cast<std::int64_t>(resolve_threads(threads));
  for (std::int64_t first = 0; first < chunks; first += together) {
    const std::int64_t count = std::min(together, chunks - first);
    std::vector<BlockChunk> found(static_cast<std::size_t>(count));
    const auto window_of = [&](std::int64_t i) {
      const std::int64_t x = i % across * side, y = i / across * side;
      return Window{inner.x + x, inner.y + y, std::min(side, inner.width - x), std::min(side, inner.height - y)};
    };
    parallel_for(count, threads, [&](std::int64_t i) {
      found[static_cast<std::size_t>(i)] = look_for_voids(reference, result, window_of(first + i));
    });
    // vector<bool> packs bits: only one thread may write it.
    for (std::int64_t i = 0; i < count; ++i) {
      const Window window = window_of(first + i);
      const BlockChunk& chunk = found[static_cast<std::size_t>(i)];
      const std::int64_t columns = window.width / block_side, rows = window.height / block_side;
      for (std::int64_t y = 0; y < rows; ++y)
        for (std::int64_t x = 0; x < columns; ++x)
          map.whole[static_cast<std::size_t>(((window.y - inner.y) / block_side + y) * map.columns +
                                             (window.x - inner.x) / block_side + x)] =
              chunk.whole[static_cast<std::size_t>(y * columns + x)] != 0;
      map.valid_cells += chunk.valid_cells;
    }
    progress.advance(count);
  }
  progress.end();
  return map;
}

struct Tiling {
  std::int64_t side = 0;
  std::vector<Window> tiles;
  double coverage = 0;
};

Tiling tile_without_voids(const ValidBlocks& map, const Window& inner, std::int64_t side) {
  Tiling tiling{side, {}, 0};
  const std::int64_t step = side / 2 / block_side, blocks = side / block_side;
  std::vector<bool> covered(map.whole.size(), false);
  for (std::int64_t y = 0; y + blocks <= map.rows; y += step)
    for (std::int64_t x = 0; x + blocks <= map.columns; x += step) {
      bool whole = true;
      for (std::int64_t j = y; whole && j < y + blocks; ++j)
        for (std::int64_t i = x; whole && i < x + blocks; ++i) whole = map.at(i, j);
      if (!whole) continue;
      tiling.tiles.push_back({inner.x + x * block_side, inner.y + y * block_side, side, side});
      for (std::int64_t j = y; j < y + blocks; ++j)
        for (std::int64_t i = x; i < x + blocks; ++i) covered[static_cast<std::size_t>(j * map.columns + i)] = true;
    }
  const auto count = static_cast<std::int64_t>(std::count(covered.begin(), covered.end(), true)) * block_side * block_side;
  tiling.coverage = map.valid_cells == 0 ? 0 : static_cast<double>(count) / static_cast<double>(map.valid_cells);
  return tiling;
}

Tiling choose_tiles(const ValidBlocks& map, const Window& inner, std::int64_t wanted) {
  Tiling best;
  for (std::int64_t side = wanted; side >= smallest_tile; side /= 2) {
    Tiling tiling = tile_without_voids(map, inner, side);
    if (tiling.coverage > best.coverage) best = std::move(tiling);
    if (best.coverage >= enough_coverage) break;
  }
  return best;
}

/// Removes the least-squares plane. On a full grid its two slopes are independent sums about the middle.
void remove_plane(Raster<float>& tile) {
  const std::int64_t n = tile.width();
  const double middle = static_cast<double>(n - 1) / 2;
  double mean = 0, along_x = 0, along_y = 0, moment = 0;
  for (std::int64_t y = 0; y < n; ++y)
    for (std::int64_t x = 0; x < n; ++x) {
      const double z = static_cast<double>(tile(x, y));
      mean += z;
      along_x += (static_cast<double>(x) - middle) * z;
      along_y += (static_cast<double>(y) - middle) * z;
    }
  for (std::int64_t i = 0; i < n; ++i) moment += (static_cast<double>(i) - middle) * (static_cast<double>(i) - middle);
  moment *= static_cast<double>(n);
  mean /= static_cast<double>(n * n);
  for (std::int64_t y = 0; y < n; ++y)
    for (std::int64_t x = 0; x < n; ++x)
      tile(x, y) -= static_cast<float>(mean + along_x / moment * (static_cast<double>(x) - middle) +
                                       along_y / moment * (static_cast<double>(y) - middle));
}

/// Periodic Hann window.
std::vector<double> hann(std::int64_t n) {
  std::vector<double> w(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < w.size(); ++i)
    w[i] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
  return w;
}

/// In place, n x n.
void transform(std::vector<Complex>& cells, std::int64_t n) {
  Eigen::FFT<double> fft;
  std::vector<Complex> line(static_cast<std::size_t>(n)), frequencies;
  const auto along = [&](std::int64_t start, std::int64_t step) {
    for (std::int64_t i = 0; i < n; ++i) line[static_cast<std::size_t>(i)] = cells[static_cast<std::size_t>(start + i * step)];
    fft.fwd(frequencies, line);
    for (std::int64_t i = 0; i < n; ++i)
      cells[static_cast<std::size_t>(start + i * step)] = frequencies[static_cast<std::size_t>(i)];
  };
  for (std::int64_t y = 0; y < n; ++y) along(y * n, 1);
  for (std::int64_t x = 0; x < n; ++x) along(x, n);
}

/// Sums of power over rings and over bands, of one tile or of many.
struct PowerSums {
  std::vector<double> ring_reference, ring_result;
  std::vector<BandPower> bands;

  void add(const PowerSums& other) {
    for (std::size_t i = 0; i < ring_reference.size(); ++i) {
      ring_reference[i] += other.ring_reference[i];
      ring_result[i] += other.ring_result[i];
    }
    for (std::size_t i = 0; i < bands.size(); ++i) {
      bands[i].reference += other.bands[i].reference;
      bands[i].result += other.bands[i].result;
    }
  }
};

PowerSums no_power(std::int64_t side, int factor) {
  const auto rings = static_cast<std::size_t>(side / 2 + 1);
  return {std::vector<double>(rings), std::vector<double>(rings), octaves_above_nyquist(factor)};
}

/// Calls visit(u, v, |k|) for every frequency of a side x side transform, k in cycles per cell.
template <typename Visit>
void for_frequencies(std::int64_t side, const Visit& visit) {
  const auto signed_of = [side](std::int64_t i) { return static_cast<double>(i <= side / 2 ? i : i - side); };
  for (std::int64_t v = 0; v < side; ++v)
    for (std::int64_t u = 0; u < side; ++u)
      visit(u, v, std::hypot(signed_of(u), signed_of(v)) / static_cast<double>(side));
}

Raster<float> read_level(const RasterSource& source, const Window& window) {
  Raster<float> tile(window.width, window.height);
  source.read(window, tile.view());
  remove_plane(tile);
  return tile;
}

PowerSums tile_power(const RasterSource& reference, const RasterSource& result, const Window& window,
                     const std::vector<double>& taper, int factor) {
  const std::int64_t n = window.width;
  const Raster<float> a = read_level(reference, window), b = read_level(result, window);
  // Two real rasters in one complex transform: a = (F(k) + conj F(-k)) / 2, b = (F(k) - conj F(-k)) / 2i.
  std::vector<Complex> cells(static_cast<std::size_t>(n * n));
  for (std::int64_t y = 0; y < n; ++y)
    for (std::int64_t x = 0; x < n; ++x)
      cells[static_cast<std::size_t>(y * n + x)] = taper[static_cast<std::size_t>(x)] * taper[static_cast<std::size_t>(y)] *
                                                   Complex(static_cast<double>(a(x, y)), static_cast<double>(b(x, y)));
  transform(cells, n);
  PowerSums sums = no_power(n, factor);
  for_frequencies(n, [&](std::int64_t u, std::int64_t v, double k) {
    const auto ring = static_cast<std::size_t>(std::lround(k * static_cast<double>(n)));
    if (ring >= sums.ring_reference.size()) return;
    const Complex f = cells[static_cast<std::size_t>(v * n + u)];
    const Complex mirrored = std::conj(cells[static_cast<std::size_t>((n - v) % n * n + (n - u) % n)]);
    const double power_reference = std::norm((f + mirrored) * 0.5), power_result = std::norm((f - mirrored) * 0.5);
    sums.ring_reference[ring] += power_reference;
    sums.ring_result[ring] += power_result;
    for (BandPower& band : sums.bands)
      if (k >= band.lower && k < band.upper) {
        band.reference += power_reference;
        band.result += power_result;
      }
  });
  return sums;
}

/// From sums to densities (rings) and powers (bands). A Hann window of sum of squares S over both axes scales |F|^2 by 1/S.
void normalise(const PowerSums& sums, const std::vector<double>& taper, SpectrumComparison& comparison) {
  double squares = 0;
  for (const double w : taper) squares += w * w;
  const double per_tile = 1 / (squares * squares * static_cast<double>(comparison.tiles));
  std::vector<double> frequencies(sums.ring_reference.size());
  for_frequencies(comparison.tile, [&](std::int64_t, std::int64_t, double k) {
    const auto ring = static_cast<std::size_t>(std::lround(k * static_cast<double>(comparison.tile)));
    if (ring < frequencies.size()) frequencies[ring] += 1;
  });
  comparison.reference = sums.ring_reference;
  comparison.result = sums.ring_result;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    comparison.reference[i] *= per_tile / frequencies[i];
    comparison.result[i] *= per_tile / frequencies[i];
  }
  comparison.bands = sums.bands;
  const double cell = 1 / static_cast<double>(comparison.tile * comparison.tile);  // of the frequency plane
  for (BandPower& band : comparison.bands) {
    band.reference *= per_tile * cell;
    band.result *= per_tile * cell;
  }
}

}  // namespace

std::vector<BandPower> octaves_above_nyquist(int factor) {
  assert(factor >= 2);
  std::vector<BandPower> bands;
  for (double lower = 0.5 / factor; lower < 0.5; lower *= 2) bands.push_back({lower, std::min(0.5, 2 * lower), 0, 0});
  return bands;
}

SpectrumComparison compare_spectra(const RasterSource& reference, const RasterSource& result, const SpectrumOptions& options,
                                   Progress& progress) {
  const Size size = reference.size();
  if (size != result.size())
    throw Error(ErrorKind::input, "cannot compare the spectra of " + std::to_string(size.width) + " x " +
                                      std::to_string(size.height) + " and " + std::to_string(result.size().width) + " x " +
                                      std::to_string(result.size().height) + " cells");
  const Window inner = inner_window(size, options.border);
  const ValidBlocks map = map_valid_blocks(reference, result, inner, options.threads, progress);
  const Tiling tiling = choose_tiles(map, inner, options.tile);
  SpectrumComparison comparison;
  comparison.bands = octaves_above_nyquist(options.factor);
  if (tiling.tiles.empty()) return comparison;
  comparison.tile = tiling.side;
  comparison.tiles = static_cast<std::int64_t>(tiling.tiles.size());
  comparison.coverage = tiling.coverage;

  const std::vector<double> taper = hann(tiling.side);
  PowerSums total = no_power(tiling.side, options.factor);
  progress.begin("comparing spectra", comparison.tiles);
  const std::int64_t together = 4 * static_cast<std::int64_t>(resolve_threads(options.threads));
  for (std::int64_t first = 0; first < comparison.tiles; first += together) {
    std::vector<PowerSums> sums(static_cast<std::size_t>(std::min(together, comparison.tiles - first)));
    parallel_for(static_cast<std::int64_t>(sums.size()), options.threads, [&](std::int64_t i) {
      sums[static_cast<std::size_t>(i)] =
          tile_power(reference, result, tiling.tiles[static_cast<std::size_t>(first + i)], taper, options.factor);
    });
    for (const PowerSums& tile : sums) total.add(tile);
    progress.advance(static_cast<std::int64_t>(sums.size()));
  }
  progress.end();
  normalise(total, taper, comparison);
  return comparison;
}

SpectrumComparison compare_spectra(RasterView<const float> reference, RasterView<const float> result,
                                   const SpectrumOptions& options) {
  NoProgress silent;
  return compare_spectra(ViewSource(reference), ViewSource(result), options, silent);
}

}  // namespace arete
