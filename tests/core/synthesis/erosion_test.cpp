#include "core/synthesis/erosion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <gtest/gtest.h>

#include "core/synthesis/spectral.h"

namespace {

using arete::Raster;

double sum(const Raster<float>& cells) {
  double total = 0;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) total += cells.data()[i];
  return total;
}

Raster<float> hills(std::int64_t side = 64) {
  return arete::synthesize_spectral({side, side}, {.beta = 1.8, .relief_m = 800, .seed = 3});
}

/// Cells lower than all of their eight neighbours, which keep water.
int pits(const Raster<float>& h) {
  int count = 0;
  for (std::int64_t y = 1; y + 1 < h.height(); ++y)
    for (std::int64_t x = 1; x + 1 < h.width(); ++x) {
      bool lowest = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) lowest = lowest && ((dx == 0 && dy == 0) || h(x, y) < h(x + dx, y + dy));
      count += lowest ? 1 : 0;
    }
  return count;
}

TEST(StreamErosion, ASingleStreamReachesItsSteadyProfile) {
  // On a ring of n cells with one outlet the water parts in the middle. Cell k from the divide drains (k + 1) cells; in the steady
  // state U = K A^m S, so with m = 1/2 the rise towards cell k is U dx / (K sqrt(k + 1) dx).
  constexpr int n = 41;
  Raster<float> terrain(n, 1), uplift(n, 1, 1.0f);
  Raster<unsigned char> outlet(n, 1, 0);
  outlet(0, 0) = 1;
  for (int x = 0; x < n; ++x) terrain(x, 0) = 0.01f * static_cast<float>(std::min(x, n - x));
  arete::StreamErosionOptions options{.cell_size_m = 10, .steps = 300, .step_years = 5, .erodibility = 0.2};
  arete::erode_by_streams(terrain.view(), std::as_const(uplift).view(), std::as_const(outlet).view(), options);

  // A raster of one row is its own neighbour above and below, diagonals included, and never lower there.
  double expected = 0;
  for (int x = 1; x <= n / 2; ++x) {
    const double drained = n / 2 - x + 1;
    expected += 1.0 / (0.2 * std::sqrt(drained * 100)) * 10;
    EXPECT_NEAR(terrain(x, 0), expected, 1e-3 * expected) << x;
  }
}

TEST(StreamErosion, OutletsKeepTheirHeightAndNothingFallsBelowThem) {
  Raster<float> terrain = hills();
  const Raster<float> uplift(64, 64, 0.0f);
  Raster<unsigned char> outlet(64, 64, 0);
  outlet(20, 30) = 1;
  terrain(20, 30) = -50;
  arete::erode_by_streams(terrain.view(), uplift.view(), std::as_const(outlet).view(), {.steps = 50, .step_years = 1e4, .erodibility = 1e-2});
  EXPECT_EQ(terrain(20, 30), -50);
  EXPECT_GE(*std::min_element(terrain.data(), terrain.data() + 64 * 64), -50);
}

TEST(StreamErosion, WithoutUpliftNoCellRisesAndPitsGoAway) {
  const Raster<float> before = hills();
  Raster<float> after = before.clone();
  const Raster<float> still(64, 64, 0.0f), rising(64, 64, 1e-3f);
  Raster<unsigned char> outlet(64, 64, 0);
  outlet(0, 0) = 1;
  const arete::StreamErosionOptions options{.steps = 5, .step_years = 1000, .erodibility = 1e-4};
  arete::erode_by_streams(after.view(), still.view(), std::as_const(outlet).view(), options);
  for (std::int64_t i = 0; i < 64 * 64; ++i) ASSERT_LE(after.data()[i], before.data()[i]);
  EXPECT_LT(sum(after), sum(before));

  // Rising ground meets the water surface over its pits after a while.
  arete::StreamErosionOptions longer = options;
  longer.steps = 300;
  arete::erode_by_streams(after.view(), rising.view(), std::as_const(outlet).view(), longer);
  EXPECT_GT(pits(before), 20);
  EXPECT_LE(pits(after), 2);
}

TEST(SettleSlopes, KeepsTheMassAndEndsAtTheTalus) {
  Raster<float> terrain = hills(32);
  const double before = sum(terrain);
  arete::settle_slopes(terrain.view(), {.cell_size_m = 20, .talus_slope = 0.6, .steps = 4000});
  EXPECT_NEAR(sum(terrain), before, 1e-5 * before);
  double steepest = 0;
  for (std::int64_t y = 0; y < 32; ++y)
    for (std::int64_t x = 0; x < 32; ++x) {
      steepest = std::max(steepest, std::abs(static_cast<double>(terrain((x + 1) % 32, y)) - terrain(x, y)) / 20);
      steepest = std::max(steepest, std::abs(static_cast<double>(terrain(x, (y + 1) % 32)) - terrain(x, y)) / 20);
    }
  EXPECT_NEAR(steepest, 0.6, 0.003);
}

TEST(SettleSlopes, LeavesGentleTerrainAndDoesNotDependOnTheThreads) {
  const Raster<float> before = hills();
  Raster<float> gentle = before.clone();
  arete::settle_slopes(gentle.view(), {.cell_size_m = 1e6});
  EXPECT_EQ(std::memcmp(before.data(), gentle.data(), 64 * 64 * sizeof(float)), 0);

  Raster<float> one = before.clone(), three = before.clone();
  arete::settle_slopes(one.view(), {.cell_size_m = 5, .threads = 1});
  arete::settle_slopes(three.view(), {.cell_size_m = 5, .threads = 3});
  EXPECT_EQ(std::memcmp(one.data(), three.data(), 64 * 64 * sizeof(float)), 0);
  EXPECT_NE(std::memcmp(one.data(), before.data(), 64 * 64 * sizeof(float)), 0);
}

}  // namespace
