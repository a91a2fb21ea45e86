#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <utility>

#include "core/terrain/raster_io.h"

namespace arete {

/// A raster whose levels have heights of their own, as those of trees have: every 2^l-th cell, 7 m higher a level. Counts the cells that are read of each.
class SourceWithLevels final : public LevelSource {
 public:
  SourceWithLevels(Raster<float> cells, int levels) : cells_(std::move(cells)), levels_(levels) {}
  int levels() const override { return levels_; }
  Size level_size(int level) const override {
    const auto along = [level](std::int64_t cells) { return ((cells - 1) >> level) + 1; };
    return {along(cells_.width()), along(cells_.height())};
  }
  float height(int level, std::int64_t x, std::int64_t y) const { return cells_(x << level, y << level) + static_cast<float>(7 * level); }
  void read_level(int level, const Window& window, RasterView<float> out) const override {
    reads[static_cast<std::size_t>(level)] += window.width * window.height;
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) = height(level, window.x + x, window.y + y);
  }

  struct Counts : std::array<std::atomic<std::int64_t>, 16> {
    void fill(std::int64_t value) {
      for (auto& count : *this) count = value;
    }
  };
  mutable Counts reads{};

 private:
  Raster<float> cells_;
  int levels_;
};

}  // namespace arete
