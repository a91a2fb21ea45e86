#include "core/amplify/shore.h"

#include <algorithm>
#include <limits>

namespace arete {
namespace {

constexpr float no_water = -std::numeric_limits<float>::infinity();

/// The highest water beside the cell that is not above it.
float water_beside(RasterView<const float> coarse, RasterView<const std::uint8_t> water, std::int64_t x, std::int64_t y) {
  float level = no_water;
  for (std::int64_t j = y - 1; j <= y + 1; ++j)
    for (std::int64_t i = x - 1; i <= x + 1; ++i)
      if (water(i, j) && coarse(i, j) <= coarse(x, y)) level = std::max(level, coarse(i, j));
  return level;
}

void lift(RasterView<float> block, float mean, float level) {
  double above = 0;
  bool dips = false;
  for (std::int64_t y = 0; y < block.height; ++y)
    for (std::int64_t x = 0; x < block.width; ++x) {
      dips |= block(x, y) < level;
      above += std::max(0.0, static_cast<double>(block(x, y)) - level);
    }
  if (!dips) return;
  const double relief = static_cast<double>(mean) - level;
  const double scale = above > 0 ? relief * static_cast<double>(block.width * block.height) / above : 0;
  for (std::int64_t y = 0; y < block.height; ++y)
    for (std::int64_t x = 0; x < block.width; ++x)
      block(x, y) = static_cast<float>(level + scale * std::max(0.0, static_cast<double>(block(x, y)) - level));
}

}  // namespace

void settle_shores(RasterView<const float> coarse, RasterView<const std::uint8_t> water, int factor, RasterView<float> fine) {
  for (std::int64_t y = 1; y + 1 < coarse.height; ++y)
    for (std::int64_t x = 1; x + 1 < coarse.width; ++x) {
      const RasterView<float> block = fine.sub({(x - 1) * factor, (y - 1) * factor, factor, factor});
      const float z = coarse(x, y);
      if (water(x, y)) {
        for (std::int64_t j = 0; j < factor; ++j) std::fill_n(block.row(j), factor, z);
        continue;
      }
      const float level = water_beside(coarse, water, x, y);
      if (level != no_water) lift(block, z, level);
    }
}

}  // namespace arete
