#include "core/synthesis/mountains.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "core/synthesis/spectral.h"

namespace {

using arete::Raster;

/// Share of the cells that are lower than their eight neighbours: water does not get out of them.
double pit_share(const Raster<float>& h) {
  std::int64_t count = 0;
  for (std::int64_t y = 1; y + 1 < h.height(); ++y)
    for (std::int64_t x = 1; x + 1 < h.width(); ++x) {
      float lowest = std::numeric_limits<float>::infinity();
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (dx != 0 || dy != 0) lowest = std::min(lowest, h(x + dx, y + dy));
      count += h(x, y) < lowest ? 1 : 0;
    }
  return static_cast<double>(count) / static_cast<double>((h.width() - 2) * (h.height() - 2));
}

TEST(Mountains, HaveTheReliefAskedForAtAnySize) {
  for (const arete::Size size : {arete::Size{200, 131}, {9, 70}, {1, 1}}) {
    const Raster<float> terrain = arete::synthesize_mountains(size, {.relief_m = 1500, .lowest_m = 200});
    ASSERT_EQ(terrain.size(), size);
    const auto [lowest, highest] = std::minmax_element(terrain.data(), terrain.data() + size.cells());
    EXPECT_FLOAT_EQ(*lowest, 200);
    EXPECT_FLOAT_EQ(*highest, size.cells() > 1 ? 1700 : 200);
  }
}

TEST(Mountains, AreDrainedBetterThanNoise) {
  const Raster<float> terrain = arete::synthesize_mountains({256, 256}, {});
  const Raster<float> noise = arete::synthesize_spectral({256, 256}, {.beta = 1.9, .relief_m = 2000});
  EXPECT_LT(pit_share(terrain), 0.25 * pit_share(noise));
}

TEST(Mountains, DependOnTheSeedAndNotOnTheThreads) {
  const auto make = [](std::uint64_t seed, int threads) {
    return arete::synthesize_mountains({96, 64}, {.seed = seed, .threads = threads});
  };
  const Raster<float> one = make(4, 1), three = make(4, 3), other = make(5, 1);
  const std::size_t bytes = 96 * 64 * sizeof(float);
  EXPECT_EQ(std::memcmp(one.data(), three.data(), bytes), 0);
  EXPECT_NE(std::memcmp(one.data(), other.data(), bytes), 0);
}

}  // namespace
