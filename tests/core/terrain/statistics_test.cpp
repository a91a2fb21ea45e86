#include "core/terrain/statistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(ElevationStatistics, OfTheFirstIntegersAreTheClosedForms) {
  // 0 ... n-1 plus a large constant: mean (n-1)/2, variance (n^2 - 1)/12. 1300 columns need more than one strip.
  Raster<float> cells(1300, 1000);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = static_cast<float>(4000000 + i);
  NoProgress progress;
  const ElevationStatistics s = elevation_statistics(ViewSource(cells.view()), progress);
  const double n = 1300000;
  EXPECT_EQ(s.valid, 1300000);
  EXPECT_EQ(s.void_share(), 0);
  EXPECT_EQ(s.lowest, 4000000);
  EXPECT_EQ(s.highest, 4000000 + n - 1);
  EXPECT_NEAR(s.mean, 4000000 + (n - 1) / 2, 1e-6);
  EXPECT_NEAR(s.deviation, std::sqrt((n * n - 1) / 12), 1e-6);
}

TEST(ElevationStatistics, LeaveVoidsOut) {
  Raster<float> cells(2, 2, void_value);
  cells(0, 1) = -5;
  cells(1, 1) = 7;
  NoProgress progress;
  const ElevationStatistics s = elevation_statistics(ViewSource(cells.view()), progress);
  EXPECT_EQ(s.void_share(), 0.5);
  EXPECT_EQ(s.lowest, -5);
  EXPECT_EQ(s.highest, 7);
  EXPECT_EQ(s.mean, 1);
  EXPECT_EQ(s.deviation, 6);
}

TEST(ElevationStatistics, OfNothingButVoidsAreZero) {
  const Raster<float> cells(3, 1, void_value);
  NoProgress progress;
  const ElevationStatistics s = elevation_statistics(ViewSource(cells.view()), progress);
  EXPECT_EQ(s.valid, 0);
  EXPECT_EQ(s.void_share(), 1);
  EXPECT_EQ(s.highest, 0);
}

TEST(Percentile, IsTheNearestValue) {
  std::vector<float> values = {9, 1, 5, 3, 7};
  EXPECT_EQ(percentile(values, 0), 1);
  EXPECT_EQ(percentile(values, 0.5), 5);
  EXPECT_EQ(percentile(values, 0.6), 5);
  EXPECT_EQ(percentile(values, 0.7), 7);
  EXPECT_EQ(percentile(values, 1), 9);
}

}  // namespace
}  // namespace arete
