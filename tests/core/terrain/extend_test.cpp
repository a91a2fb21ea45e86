#include "core/terrain/extend.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

constexpr int reach = 4;

double plane_at(std::int64_t x, std::int64_t y) { return 3000 + 17.3 * static_cast<double>(x) - 9.1 * static_cast<double>(y); }

Raster<float> plane(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = static_cast<float>(plane_at(x, y));
  return cells;
}

Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const auto i = static_cast<std::uint64_t>(x), j = static_cast<std::uint64_t>(y);
      const bool hole = std::hypot(static_cast<double>(x) - 20, static_cast<double>(y) - 15) < 8 || uniform_at(2, i, j) < 0.03;
      cells(x, y) = hole ? void_value : static_cast<float>(1000 + 100 * uniform_at(1, i, j));
    }
  return cells;
}

std::int64_t distance_to_valid(RasterView<const float> known, std::int64_t x, std::int64_t y) {
  std::int64_t nearest = known.width + known.height;
  for (std::int64_t j = 0; j < known.height; ++j)
    for (std::int64_t i = 0; i < known.width; ++i)
      if (!is_void(known(i, j))) nearest = std::min(nearest, std::max(std::abs(i - x), std::abs(j - y)));
  return nearest;
}

Raster<float> extend(RasterView<const float> known, int by = reach) {
  Raster<float> out(known.width, known.height);
  extend_into_voids(known, by, out.view());
  return out;
}

// The margin of a raster is the commonest void: sides, corners, and the cells that are just in reach.
TEST(Extend, APlaneIsContinuedBeyondSidesAndCorners) {
  for (const int by : {2, 4, 7}) {
    Raster<float> known = plane(50, 40);
    for (std::int64_t y = 0; y < 40; ++y)
      for (std::int64_t x = 0; x < 50; ++x)
        if (x < 12 || y < 12 || x >= 38 || y >= 28) known(x, y) = void_value;
    const Raster<float> out = extend(known.view(), by);
    double worst = 0;
    for (std::int64_t y = 12 - by; y < 28 + by; ++y)
      for (std::int64_t x = 12 - by; x < 38 + by; ++x) worst = std::max(worst, std::abs(static_cast<double>(out(x, y)) - plane_at(x, y)));
    // Elevations are rounded to 0.24 mm; a slope over a few cells continued as far again multiplies that.
    EXPECT_LT(worst, 1e-3) << "reach " << by;
  }
}

TEST(Extend, APlaneIsContinuedIntoHoles) {
  Raster<float> known = plane(50, 40);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 50; ++x)
      if (std::hypot(static_cast<double>(x) - 24, static_cast<double>(y) - 18) < 11 || (x == 3 && y > 5)) known(x, y) = void_value;
  const Raster<float> out = extend(known.view());
  double worst = 0;
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 50; ++x)
      if (!is_void(out(x, y))) worst = std::max(worst, std::abs(static_cast<double>(out(x, y)) - plane_at(x, y)));
  EXPECT_LT(worst, 1e-3);
}

TEST(Extend, ReachesExactlyAsFarAsAsked) {
  const Raster<float> known = rough(48, 36);
  for (const int by : {1, 2, 4, 7}) {
    const Raster<float> out = extend(known.view(), by);
    for (std::int64_t y = 0; y < 36; ++y)
      for (std::int64_t x = 0; x < 48; ++x) ASSERT_EQ(is_void(out(x, y)), distance_to_valid(known.view(), x, y) > by) << x << ", " << y;
  }
}

TEST(Extend, ValidCellsStayAsTheyAre) {
  const Raster<float> known = rough(48, 36), out = extend(known.view());
  for (std::int64_t i = 0; i < known.size().cells(); ++i)
    if (!is_void(known.data()[i])) {
      EXPECT_EQ(out.data()[i], known.data()[i]);
    }
}

TEST(Extend, AWindowWithItsMarginIsThePartOfTheWhole) {
  const Raster<float> known = rough(48, 36), whole = extend(known.view());
  constexpr std::int64_t margin = reach + extend_support;
  const Window window{13, 10, 15, 12};
  const Raster<float> part =
      extend(known.view().sub({window.x - margin, window.y - margin, window.width + 2 * margin, window.height + 2 * margin}));
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) {
      const float a = part(x + margin, y + margin), b = whole(x + window.x, y + window.y);
      EXPECT_TRUE(a == b || (is_void(a) && is_void(b))) << x << ", " << y << ": " << a << ", " << b;
    }
}

TEST(Extend, ALineOfCellsIsContinuedByAMeanAndNothingByNothing) {
  Raster<float> known(21, 21, void_value);
  for (std::int64_t x = 0; x < 21; ++x) known(x, 10) = 50;
  const Raster<float> line = extend(known.view());
  EXPECT_FLOAT_EQ(line(10, 6), 50);
  EXPECT_FLOAT_EQ(line(10, 14), 50);
  EXPECT_TRUE(is_void(line(10, 5)));
  const Raster<float> none = extend(Raster<float>(9, 9, void_value).view());
  for (std::int64_t i = 0; i < 81; ++i) EXPECT_TRUE(is_void(none.data()[i]));
}

TEST(Extend, AConstantIsContinuedToTheLastBit) {
  Raster<float> known(30, 30, 1234.567f);
  for (std::int64_t y = 8; y < 20; ++y)
    for (std::int64_t x = 0; x < 9; ++x) known(x, y) = void_value;
  const Raster<float> out = extend(known.view());
  for (std::int64_t i = 0; i < 900; ++i)
    if (!is_void(out.data()[i])) {
      EXPECT_EQ(out.data()[i], 1234.567f);
    }
}

}  // namespace
}  // namespace arete
