#include "core/terrain/ground_style.h"

#include <gtest/gtest.h>

#include <cmath>

namespace arete {
namespace {

TEST(GroundStyle, ContoursStandAtRoundHeightsAndAreNeitherFewNorMany) {
  EXPECT_DOUBLE_EQ(contour_interval(2400), 100);
  EXPECT_DOUBLE_EQ(contour_interval(24 * 141), 100);
  EXPECT_DOUBLE_EQ(contour_interval(24 * 142), 200);
  EXPECT_DOUBLE_EQ(contour_interval(1.2), 0.05);
  for (double relief = 0.01; relief < 9000; relief *= 1.03) {
    const double interval = contour_interval(relief), digit = interval / std::pow(10, std::floor(std::log10(interval) + 1e-9));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 || std::abs(digit - 5) < 1e-9) << relief;
    // The widest gap is from 2 to 5.
    EXPECT_GE(relief / interval, 24 / std::sqrt(2.5) - 1e-9);
    EXPECT_LE(relief / interval, 24 * std::sqrt(2.5) + 1e-9);
  }
  EXPECT_EQ(contour_interval(0), 1);
  EXPECT_EQ(contour_interval(std::nan("")), 1);
}

TEST(GroundStyle, TheScaleOfSlopesHoldsTheSteepest) {
  EXPECT_EQ(slope_scale_deg(0), 2);
  EXPECT_EQ(slope_scale_deg(45), 45);
  EXPECT_EQ(slope_scale_deg(45.1), 60);
  EXPECT_EQ(slope_scale_deg(89), 90);
}

}  // namespace
}  // namespace arete
