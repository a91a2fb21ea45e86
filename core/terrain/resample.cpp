#include "core/terrain/resample.h"

#include <algorithm>
#include <array>
#include <vector>

namespace arete {

Raster<float> area_average(RasterView<const float> fine, int factor) {
  Raster<float> coarse(fine.width / factor, fine.height / factor);
  const double area = static_cast<double>(factor) * factor;
  for (std::int64_t y = 0; y < coarse.height(); ++y)
    for (std::int64_t x = 0; x < coarse.width(); ++x) {
      double sum = 0;
      for (int dy = 0; dy < factor; ++dy)
        for (int dx = 0; dx < factor; ++dx) sum += static_cast<double>(fine(x * factor + dx, y * factor + dy));
      coarse(x, y) = static_cast<float>(sum / area);
    }
  return coarse;
}

namespace {

std::array<double, 4> catmull_rom(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {(-t3 + 2 * t2 - t) / 2, (3 * t3 - 5 * t2 + 2) / 2, (-3 * t3 + 4 * t2 + t) / 2, (t3 - t2) / 2};
}

struct Tap {
  std::int64_t first;  // coarse index of the first of four cells
  std::array<double, 4> weight;
};

std::vector<Tap> taps_of(std::int64_t coarse_length, int factor) {
  std::vector<Tap> taps(static_cast<std::size_t>(coarse_length * factor));
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const double position = (static_cast<double>(i) + 0.5) / factor - 0.5;
    const double cell = std::floor(position);
    taps[i] = {static_cast<std::int64_t>(cell) - 1, catmull_rom(position - cell)};
  }
  return taps;
}

}  // namespace

Raster<float> upsample_bicubic(RasterView<const float> coarse, int factor) {
  Raster<float> fine(coarse.width * factor, coarse.height * factor);
  const std::vector<Tap> columns = taps_of(coarse.width, factor), rows = taps_of(coarse.height, factor);
  for (std::int64_t y = 0; y < fine.height(); ++y) {
    const Tap& row = rows[static_cast<std::size_t>(y)];
    for (std::int64_t x = 0; x < fine.width(); ++x) {
      const float own = coarse(x / factor, y / factor);
      if (is_void(own)) {
        fine(x, y) = void_value;
        continue;
      }
      const Tap& column = columns[static_cast<std::size_t>(x)];
      double sum = 0;
      for (int j = 0; j < 4; ++j) {
        const std::int64_t cy = std::clamp<std::int64_t>(row.first + j, 0, coarse.height - 1);
        double line = 0;
        for (int i = 0; i < 4; ++i) {
          const float z = coarse(std::clamp<std::int64_t>(column.first + i, 0, coarse.width - 1), cy);
          line += column.weight[static_cast<std::size_t>(i)] * static_cast<double>(is_void(z) ? own : z);
        }
        sum += row.weight[static_cast<std::size_t>(j)] * line;
      }
      fine(x, y) = static_cast<float>(sum);
    }
  }
  return fine;
}

}  // namespace arete
