#include "core/amplify/shore.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/terrain/flat_water.h"
#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

constexpr int factor = 4;

/// A bay: level water at 12 m, land above it, one cell of a polder below.
struct Bay {
  Bay() : coarse(fractal_terrain(20, 20, 1, 2, 0, 60)), fine(18 * factor, 18 * factor) {
    for (std::int64_t y = 0; y < 20; ++y)
      for (std::int64_t x = 0; x < 20; ++x) coarse(x, y) = x < 8 && y < 9 ? 12.0f : 12.5f + coarse(x, y);
    coarse(8, 4) = 9;  // beside the water, below it
    water = find_flat_water(coarse.view());
    // Every fine block swings by 40 m about the mean of its cell, so that all land beside the water dips.
    for (std::int64_t y = 0; y < fine.height(); ++y)
      for (std::int64_t x = 0; x < fine.width(); ++x)
        fine(x, y) = coarse(x / factor + 1, y / factor + 1) + static_cast<float>(10 * (x % factor) - 15 + 4 * (y % factor) - 6);
    before = fine.clone();
    settle_shores(coarse.view(), water.view(), factor, fine.view());
  }
  bool beside_water(std::int64_t x, std::int64_t y) const {
    for (std::int64_t j = y - 1; j <= y + 1; ++j)
      for (std::int64_t i = x - 1; i <= x + 1; ++i)
        if (water(i, j)) return true;
    return false;
  }
  Raster<float> coarse, fine, before;
  Raster<std::uint8_t> water;
};

TEST(Shore, WaterIsLevelToTheLastBit) {
  const Bay bay;
  std::int64_t cells = 0;
  for (std::int64_t y = 0; y < bay.fine.height(); ++y)
    for (std::int64_t x = 0; x < bay.fine.width(); ++x)
      if (bay.water(x / factor + 1, y / factor + 1)) {
        EXPECT_EQ(bay.fine(x, y), 12.0f);
        ++cells;
      }
  EXPECT_EQ(cells, 7 * 8 * factor * factor);
}

TEST(Shore, LandBesideItDoesNotDipBelowAndKeepsItsMean) {
  const Bay bay;
  for (std::int64_t y = 1; y < 19; ++y)
    for (std::int64_t x = 1; x < 19; ++x) {
      if (bay.water(x, y) || !bay.beside_water(x, y) || bay.coarse(x, y) < 12) continue;
      double sum = 0;
      for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i) {
          const float z = bay.fine((x - 1) * factor + i, (y - 1) * factor + j);
          EXPECT_GE(z, 12.0f);
          sum += static_cast<double>(z);
        }
      EXPECT_NEAR(sum / 16, bay.coarse(x, y), 1e-5) << x << ", " << y;
    }
}

TEST(Shore, InlandAndBelowTheWaterNothingChanges) {
  const Bay bay;
  for (std::int64_t y = 1; y < 19; ++y)
    for (std::int64_t x = 1; x < 19; ++x) {
      if (bay.beside_water(x, y) && bay.coarse(x, y) >= 12) continue;
      const Window block{(x - 1) * factor, (y - 1) * factor, factor, factor};
      EXPECT_TRUE(same_bits(bay.fine.view().sub(block), bay.before.view().sub(block))) << x << ", " << y;
    }
}

TEST(Shore, SettlingTwiceChangesNothingMore) {
  Bay bay;
  const Raster<float> once = bay.fine.clone();
  settle_shores(bay.coarse.view(), bay.water.view(), factor, bay.fine.view());
  EXPECT_TRUE(same_bits(once.view(), bay.fine.view()));
}

TEST(Shore, ACellLevelWithTheWaterBecomesLevel) {
  Bay bay;
  bay.coarse(8, 4) = 12;
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) bay.fine(7 * factor + i, 3 * factor + j) = 12 + static_cast<float>(i - 1.5);
  settle_shores(bay.coarse.view(), bay.water.view(), factor, bay.fine.view());
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) EXPECT_EQ(bay.fine(7 * factor + i, 3 * factor + j), 12.0f);
}

}  // namespace
}  // namespace arete
