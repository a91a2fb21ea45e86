// Chan, T. F., Golub, G. H., LeVeque, R. J.: Algorithms for computing the sample variance. The American Statistician 37(3), 1983.
#include "core/terrain/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace arete {
namespace {

struct Moments {
  double count = 0, mean = 0, squares = 0;  // squares: sum of squared distances from the mean
  float lowest = std::numeric_limits<float>::infinity();
  float highest = -std::numeric_limits<float>::infinity();
};

Moments moments_of(RasterView<const float> cells) {
  Moments m;
  double sum = 0;
  const auto each_valid = [&](auto&& visit) {
    for (std::int64_t y = 0; y < cells.height; ++y)
      for (std::int64_t x = 0; x < cells.width; ++x)
        if (!is_void(cells(x, y))) visit(cells(x, y));
  };
  each_valid([&](float z) {
    m.count += 1;
    sum += static_cast<double>(z);
    m.lowest = std::min(m.lowest, z);
    m.highest = std::max(m.highest, z);
  });
  if (m.count == 0) return m;
  m.mean = sum / m.count;
  each_valid([&](float z) { m.squares += (static_cast<double>(z) - m.mean) * (static_cast<double>(z) - m.mean); });
  return m;
}

void join(Moments& a, const Moments& b) {
  if (b.count == 0) return;
  const double count = a.count + b.count, apart = b.mean - a.mean;
  a.squares += b.squares + apart * apart * a.count * b.count / count;
  a.mean += apart * b.count / count;
  a.count = count;
  a.lowest = std::min(a.lowest, b.lowest);
  a.highest = std::max(a.highest, b.highest);
}

}  // namespace

ElevationStatistics elevation_statistics(const RasterSource& source, Progress& progress) {
  constexpr std::int64_t strip_cells = 1 << 20;
  const Size size = source.size();
  const std::int64_t rows = std::clamp<std::int64_t>(strip_cells / std::max<std::int64_t>(1, size.width), 1, std::max<std::int64_t>(1, size.height));
  Raster<float> strip(size.width, rows);
  Moments all;
  progress.begin("reading elevations", size.cells());
  for (std::int64_t y = 0; y < size.height; y += rows) {
    const Window window{0, y, size.width, std::min(rows, size.height - y)};
    const RasterView<float> cells = strip.view().sub({0, 0, window.width, window.height});
    source.read(window, cells);
    join(all, moments_of(cells));
    progress.advance(window.width * window.height);
  }
  progress.end();
  ElevationStatistics result;
  result.cells = size.cells();
  result.valid = static_cast<std::int64_t>(all.count);
  if (result.valid == 0) return result;
  result.lowest = static_cast<double>(all.lowest);
  result.highest = static_cast<double>(all.highest);
  result.mean = all.mean;
  result.deviation = std::sqrt(all.squares / all.count);
  return result;
}

double percentile(std::vector<float>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

}  // namespace arete
