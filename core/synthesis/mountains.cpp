#include "core/synthesis/mountains.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/support/parallel.h"
#include "core/support/random.h"
#include "core/synthesis/erosion.h"
#include "core/synthesis/spectral.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

// Chosen by eye on hillshades, and for a spectrum near that of the Alps: power falling as f^-4 over two decades.
constexpr int coarsest_factor = 8;
constexpr double spectral_beta = 1.9;
constexpr double floor_share = 0.06;        // of the cells lie on the floors, where streams end
constexpr double incision = 0.1;            // share of the drop to the next cell that one cell's own water removes in a step
constexpr double rise_share = 1.0 / 80;     // of the relief by which the highest massif rises in a step
constexpr int steps_at[] = {2, 3, 5, 20};   // from fine to coarse
constexpr double hillslope_cells = 20;      // drain through a hillslope
constexpr double talus_slope = 0.8;
constexpr double detail_share = 0.8;         // of the spectral terrain's detail that is added before streams work on it
constexpr double bend_beta = 1.6;
constexpr double bend_cells = 3;
constexpr int talus_steps = 10;

/// The level below which `share` of the cells lie.
float quantile(RasterView<const float> cells, double share) {
  std::vector<float> sorted;
  for (std::int64_t y = 0; y < cells.height; ++y) sorted.insert(sorted.end(), cells.row(y), cells.row(y) + cells.width);
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[static_cast<std::size_t>(rank)];
}

/// Streams at one level of detail, with cells of `cell_size_m`. `massif` is the spectral terrain there, 0 to 1.
void erode_level(Raster<float>& terrain, const Raster<float>& massif, float floor, int steps, double cell_size_m,
                 const MountainOptions& how) {
  Raster<float> uplift(terrain.width(), terrain.height());
  Raster<unsigned char> outlet(terrain.width(), terrain.height());
  parallel_for(terrain.height(), how.threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < terrain.width(); ++x) {
      const float above = std::max(0.0f, massif(x, y) - floor) / (1 - floor);
      uplift(x, y) = static_cast<float>(rise_share * how.relief_m * std::sqrt(above));
      outlet(x, y) = massif(x, y) <= floor ? 1 : 0;
    }
  });
  // With an exponent of a half and a step of one year, a stream of n cells removes `incision` sqrt(n) at any resolution.
  const StreamErosionOptions options{.cell_size_m = cell_size_m,
                                     .steps = steps,
                                     .step_years = 1,
                                     .erodibility = incision,
                                     .area_exponent = 0.5,
                                     .least_area_m2 = hillslope_cells * how.cell_size_m * how.cell_size_m,
                                     .seed = hash_position(how.seed, static_cast<std::uint64_t>(terrain.width())),
                                     .threads = how.threads};
  erode_by_streams(terrain.view(), std::as_const(uplift).view(), std::as_const(outlet).view(), options);
}

/// Between cells, on a periodic terrain.
float sample_bilinear(const Raster<float>& cells, double x, double y) {
  const auto wrap = [](double i, std::int64_t n) { return (static_cast<std::int64_t>(i) % n + n) % n; };
  const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
  const std::int64_t left = wrap(x0, cells.width()), right = wrap(x0 + 1, cells.width());
  const std::int64_t top = wrap(y0, cells.height()), bottom = wrap(y0 + 1, cells.height());
  return static_cast<float>((1 - v) * ((1 - u) * cells(left, top) + u * cells(right, top)) +
                            v * ((1 - u) * cells(left, bottom) + u * cells(right, bottom)));
}

/// The next finer level: the coarse terrain, bent a little so that valleys wind, plus what the spectral terrain has there and the
/// coarser level could not show.
Raster<float> add_level(const Raster<float>& coarse, const Raster<float>& coarse_massif, const Raster<float>& massif,
                        const MountainOptions& how) {
  const SpectralOptions noise{.beta = bend_beta, .relief_m = 2 * bend_cells, .seed = hash_position(how.seed, 1), .threads = how.threads};
  SpectralOptions other = noise;
  other.seed = hash_position(how.seed, 2);
  const Raster<float> bend_x = synthesize_spectral(coarse.size(), noise), bend_y = synthesize_spectral(coarse.size(), other);
  Raster<float> bent(coarse.width(), coarse.height());
  parallel_for(coarse.height(), how.threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < coarse.width(); ++x)
      bent(x, y) = sample_bilinear(coarse, static_cast<double>(x) + bend_x(x, y) - bend_cells, static_cast<double>(y) + bend_y(x, y) - bend_cells);
  });
  Raster<float> fine = upsample_bicubic(bent.view(), 2);
  const Raster<float> known = upsample_bicubic(coarse_massif.view(), 2);
  const auto gain = static_cast<float>(detail_share * how.relief_m);
  for (std::int64_t i = 0; i < fine.size().cells(); ++i) fine.data()[i] += gain * (massif.data()[i] - known.data()[i]);
  return fine;
}

void scale_to(RasterView<float> cells, double lowest, double relief) {
  float low = cells(0, 0), high = low;
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) low = std::min(low, cells(x, y)), high = std::max(high, cells(x, y));
  const double scale = high > low ? relief / (static_cast<double>(high) - low) : 0;
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x)
      cells(x, y) = static_cast<float>(lowest + (static_cast<double>(cells(x, y)) - low) * scale);
}

}  // namespace

Raster<float> synthesize_mountains(Size size, const MountainOptions& options) {
  const auto whole = [](std::int64_t n) { return (n + coarsest_factor - 1) / coarsest_factor * coarsest_factor; };
  const Size grid{whole(size.width), whole(size.height)};
  std::vector<Raster<float>> massifs;  // from fine to coarse
  massifs.push_back(synthesize_spectral(grid, {.beta = spectral_beta, .relief_m = 1, .seed = options.seed, .threads = options.threads}));
  for (int factor = 2; factor <= coarsest_factor; factor *= 2) massifs.push_back(area_average(massifs.back().view(), 2));
  const float floor = quantile(std::as_const(massifs.back()).view(), floor_share);

  Raster<float> terrain = massifs.back().clone();
  scale_to(terrain.view(), options.lowest_m, options.relief_m);
  for (std::size_t level = massifs.size(); level-- > 0;) {
    if (level + 1 < massifs.size())
      terrain = add_level(terrain, massifs[level + 1], massifs[level], options);
    erode_level(terrain, massifs[level], floor, steps_at[level], options.cell_size_m * (1 << level), options);
    scale_to(terrain.view(), options.lowest_m, options.relief_m);
  }
  settle_slopes(terrain.view(), {.cell_size_m = options.cell_size_m, .talus_slope = talus_slope, .steps = talus_steps, .threads = options.threads});

  Raster<float> cropped(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y) std::copy_n(terrain.view().row(y), size.width, cropped.view().row(y));
  scale_to(cropped.view(), options.lowest_m, options.relief_m);
  return cropped;
}

}  // namespace arete
