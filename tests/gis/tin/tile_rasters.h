#pragma once

#include <cmath>

#include "core/support/random.h"
#include "core/terrain/raster.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// A raster in memory as a source.
class HeldRaster final : public RasterSource {
 public:
  explicit HeldRaster(Raster<float> cells) : cells_(std::move(cells)) {}
  Size size() const override { return cells_.size(); }
  void read(const Window& window, RasterView<float> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) = cells_(window.x + x, window.y + y);
  }
  RasterView<const float> view() const { return cells_.view(); }

 private:
  Raster<float> cells_;
};

/// Waves with noise of so many metres on them.
inline Raster<float> noisy_waves(std::int64_t width, std::int64_t height, double noise) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(500 + 80 * std::sin(static_cast<double>(x) / 37) + 60 * std::cos(static_cast<double>(x + 2 * y) / 53) +
                                       noise * uniform_at(1, static_cast<std::uint64_t>(y * width + x)));
  return cells;
}

}  // namespace arete
