#include "core/amplify/octaves.h"

#include <algorithm>

#include "core/support/parallel.h"

namespace arete {
namespace {

Raster<float> smooth(RasterView<const float> from, std::int64_t spacing, int threads) {
  const std::int64_t w = from.width, h = from.height;
  constexpr float kernel[5] = {1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};
  Raster<float> columns(w, h), both(w, h);
  parallel_for(h, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < w; ++x) {
      float sum = 0;
      for (int k = 0; k < 5; ++k) sum += kernel[k] * from(x, std::clamp<std::int64_t>(y + (k - 2) * spacing, 0, h - 1));
      columns(x, y) = sum;
    }
  });
  parallel_for(h, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < w; ++x) {
      float sum = 0;
      for (int k = 0; k < 5; ++k) sum += kernel[k] * columns(std::clamp<std::int64_t>(x + (k - 2) * spacing, 0, w - 1), y);
      both(x, y) = sum;
    }
  });
  return both;
}

}  // namespace

std::vector<Raster<float>> split_octaves(RasterView<const float> detail, int factor, int threads) {
  Raster<float> rest(detail.width, detail.height);
  for (std::int64_t y = 0; y < detail.height; ++y)
    for (std::int64_t x = 0; x < detail.width; ++x) rest(x, y) = is_void(detail(x, y)) ? 0.0f : detail(x, y);
  std::vector<Raster<float>> octaves;
  for (std::int64_t spacing = 1; spacing < factor; spacing *= 2) {
    Raster<float> smoother = smooth(std::as_const(rest).view(), spacing, threads);
    for (std::int64_t i = 0; i < rest.size().cells(); ++i) rest.data()[i] -= smoother.data()[i];
    octaves.push_back(std::move(rest));
    rest = std::move(smoother);
  }
  return octaves;
}

}  // namespace arete
