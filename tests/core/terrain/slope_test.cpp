#include "core/terrain/slope.h"

#include <cmath>

#include <gtest/gtest.h>

namespace arete {
namespace {

constexpr CellSize cell{10, 20};

/// Rises 0.3 per metre eastward and 0.4 per metre northward: the slope is atan(0.5).
Raster<float> plane(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(0.3 * cell.x_m * static_cast<double>(x) - 0.4 * cell.y_m * static_cast<double>(y));
  return cells;
}

TEST(HornGradient, IsExactOnAPlaneUpToTheBorder) {
  const Raster<float> cells = plane(7, 5);
  for (std::int64_t y = 0; y < 5; ++y)
    for (std::int64_t x = 0; x < 7; ++x) {
      const auto gradient = horn_gradient(cells.view(), x, y, cell);
      ASSERT_TRUE(gradient);
      EXPECT_NEAR(gradient->east, 0.3, 1e-6);
      EXPECT_NEAR(gradient->north, 0.4, 1e-6);
    }
}

TEST(HornGradient, AVoidLeaksNowhereAndHasNoGradient) {
  Raster<float> cells = plane(7, 5);
  cells(3, 2) = void_value;
  cells(6, 0) = void_value;
  for (std::int64_t y = 0; y < 5; ++y)
    for (std::int64_t x = 0; x < 7; ++x) {
      const auto gradient = horn_gradient(cells.view(), x, y, cell);
      ASSERT_EQ(gradient.has_value(), !is_void(cells(x, y))) << x << ' ' << y;
      if (!gradient) continue;
      EXPECT_NEAR(gradient->east, 0.3, 1e-6);
      EXPECT_NEAR(gradient->north, 0.4, 1e-6);
    }
}

// The weights of Horn's formula, worked by hand: [(3 + 2 6 + 9) - (1 + 2 4 + 7)] / 8 = 1, [(1 + 2 2 + 3) - (7 + 2 8 + 9)] / 8 = -3,
// then one corner raised by 8 adds 1 to the first and takes 1 from the second.
TEST(HornGradient, WeighsTheEightNeighboursAsHorn) {
  Raster<float> cells(3, 3);
  for (int i = 0; i < 9; ++i) cells.data()[i] = static_cast<float>(i + 1);
  cells(2, 2) += 8;
  const auto gradient = complete_gradient(cells.view(), 1, 1, {1, 1});
  ASSERT_TRUE(gradient);
  EXPECT_DOUBLE_EQ(gradient->east, 2);
  EXPECT_DOUBLE_EQ(gradient->north, -4);
}

TEST(CompleteGradient, NeedsAllNineCells) {
  Raster<float> cells = plane(5, 5);
  EXPECT_FALSE(complete_gradient(cells.view(), 0, 2, cell));
  EXPECT_FALSE(complete_gradient(cells.view(), 2, 4, cell));
  EXPECT_TRUE(complete_gradient(cells.view(), 1, 1, cell));
  for (const auto& [x, y] : {std::pair{1, 1}, {2, 1}, {3, 3}, {2, 2}}) {
    Raster<float> holed = cells.clone();
    holed(x, y) = void_value;
    EXPECT_FALSE(complete_gradient(holed.view(), 2, 2, cell)) << x << ' ' << y;
  }
}

TEST(Aspect, IsTheDownhillCompassDirection) {
  EXPECT_DOUBLE_EQ(aspect_deg({0, -1}), 0);    // falls to the north
  EXPECT_DOUBLE_EQ(aspect_deg({-1, 0}), 90);   // falls to the east
  EXPECT_DOUBLE_EQ(aspect_deg({0, 1}), 180);
  EXPECT_DOUBLE_EQ(aspect_deg({1, 0}), 270);
  EXPECT_DOUBLE_EQ(aspect_deg({0, 0}), 0);
}

TEST(Slope, OfAPlaneIsItsAngleForAnyThreadCount) {
  const Raster<float> cells = plane(20, 12);
  Raster<float> out(6, 4);
  for (const int threads : {1, 3}) {
    slope(cells.view(), {5, 5, 6, 4}, cell, out.view(), threads);
    for (int i = 0; i < 24; ++i) EXPECT_NEAR(out.data()[i], 26.565051, 1e-4);  // atan(0.5)
  }
}

TEST(ExaggerationFor, MakesGentleSlopesVisibleAndLeavesMountains) {
  EXPECT_EQ(exaggeration_for(0.6, 30, 12), 1);
  EXPECT_EQ(exaggeration_for(0.1, 30, 12), 5);   // tan 30 is 0.577
  EXPECT_EQ(exaggeration_for(0.001, 30, 12), 12);
  EXPECT_EQ(exaggeration_for(0.001, 20, 6), 6);
  EXPECT_EQ(exaggeration_for(0, 30, 12), 1);
}

}  // namespace
}  // namespace arete
