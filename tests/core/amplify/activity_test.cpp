#include "core/amplify/activity.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/sparse/patch_grid.h"
#include "core/sparse/patches.h"
#include "core/support/random.h"

namespace arete {
namespace {

std::vector<float> random_cells(int m, std::uint64_t seed, double scale) {
  std::vector<float> cells;
  for (int i = 0; i < m * m; ++i) cells.push_back(static_cast<float>(2000 + scale * uniform_at(seed, static_cast<std::uint64_t>(i))));
  return cells;
}

// Float elevations of a plane are rounded; that is no relief, at any height and slope.
TEST(Activity, OfAPlaneIsZero) {
  for (const int m : {4, 6, 8, 16})
    for (const double base : {0.0, 12.0, 3000.0, -400.0, 8800.0})
      for (const double slope : {0.001, 0.37, 7.3, 61.7}) {
        std::vector<float> cells;
        for (int y = 0; y < m; ++y)
          for (int x = 0; x < m; ++x) cells.push_back(static_cast<float>(base + slope * x - 0.613 * slope * y));
        EXPECT_EQ(ActivityMeter(m).measure(cells.data()), 0) << m << " cells, base " << base << " slope " << slope;
      }
}

TEST(Activity, IsTheSameUnderTheEightSymmetries) {
  constexpr int m = 8;
  const ActivityMeter meter(m);
  const std::vector<float> cells = random_cells(m, 1, 100);
  const float expected = meter.measure(cells.data());
  for (std::uint8_t s = 0; s < 8; ++s) {
    std::vector<float> turned(cells.size());
    for (int y = 0; y < m; ++y)
      for (int x = 0; x < m; ++x) {
        const CellIndex from = source_cell(x, y, m, s);
        turned[static_cast<std::size_t>(y * m + x)] = cells[static_cast<std::size_t>(from.y * m + from.x)];
      }
    EXPECT_NEAR(meter.measure(turned.data()), expected, 1e-5 * expected);
  }
}

TEST(Activity, DoublesWithDoubledHeights) {
  const ActivityMeter meter(8);
  std::vector<float> cells = random_cells(8, 2, 100);
  const float once = meter.measure(cells.data());
  for (float& z : cells) z *= 2;
  EXPECT_FLOAT_EQ(meter.measure(cells.data()), 2 * once);
}

TEST(Activity, IsIndependentOfTheHeight) {
  const ActivityMeter meter(8);
  std::vector<float> cells = random_cells(8, 3, 100);
  const float high = meter.measure(cells.data());
  for (float& z : cells) z -= 2000;
  EXPECT_NEAR(meter.measure(cells.data()), high, 1e-4 * high);
}

// z = g x + c x^2 / 2: |grad z| = g + c x, |H z| = c everywhere; on the weighted mean of 4 x 4 samples, symmetric about x = 3/2.
TEST(Activity, OfAParabolaIsTheGeometricMeanOfSlopeAndCurvature) {
  constexpr int m = 6;
  constexpr double g = 3, c = 2;
  std::vector<float> cells;
  for (int y = 0; y < m; ++y)
    for (int x = 0; x < m; ++x) cells.push_back(static_cast<float>(g * x + c * x * x / 2));
  const std::vector<float> disc = disc_weights(m);
  double slope = 0, total = 0;
  for (int y = 1; y < 5; ++y)
    for (int x = 1; x < 5; ++x) {
      const auto w = static_cast<double>(disc[static_cast<std::size_t>(y * m + x)]);
      slope += w * std::pow(g + c * x, 2);
      total += w;
    }
  EXPECT_NEAR(ActivityMeter(m).measure(cells.data()), std::pow(slope / total * c * c, 0.25), 1e-5);
}

// z = t x y has the mixed derivative alone: |H z|^2 = 2 t^2.
TEST(Activity, CountsTheMixedDerivativeTwice) {
  constexpr int m = 4;
  std::vector<float> cells;
  for (int y = 0; y < m; ++y)
    for (int x = 0; x < m; ++x) cells.push_back(static_cast<float>(5 * x * y));
  // Samples 1 and 2 of each direction have equal weights: <|grad z|^2> = 25 <x^2 + y^2> = 25 * 5.
  EXPECT_NEAR(ActivityMeter(m).measure(cells.data()), std::pow(25 * 5 * 2 * 25.0, 0.25), 1e-5);
}

TEST(Activity, OfAVoidIsVoid) {
  std::vector<float> cells = random_cells(8, 4, 10);
  cells[27] = void_value;
  EXPECT_TRUE(std::isnan(ActivityMeter(8).measure(cells.data())));
}

}  // namespace
}  // namespace arete
