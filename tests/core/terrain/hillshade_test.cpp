#include "core/terrain/hillshade.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

Raster<float> plane(std::int64_t width, std::int64_t height, double east, double north) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(east * static_cast<double>(x) - north * static_cast<double>(y));
  return cells;
}

Raster<float> shade_all_of(const Raster<float>& cells, const HillshadeOptions& options = {}, int threads = 0) {
  Raster<float> out(cells.width(), cells.height());
  hillshade(cells.view(), {0, 0, cells.width(), cells.height()}, {1, 1}, options, out.view(), threads);
  return out;
}

TEST(Hillshade, OfAPlaneIsConstant) {
  const Raster<float> out = shade_all_of(plane(9, 6, 0.5, -0.25));
  for (int i = 1; i < 54; ++i) EXPECT_NEAR(out.data()[i], out.data()[0], 1e-6);
}

TEST(Hillshade, OfFlatGroundIsTheSineOfTheAltitude) {
  const Raster<float> out = shade_all_of(Raster<float>(4, 4, 12.0f), {1, 30, {}});
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(out.data()[i], 0.5, 1e-6);
}

TEST(Hillshade, OneLightIsTheCosineOfTheIncidence) {
  // A slope of 45 degrees that falls to the north-west faces a light at 45 degrees from there, and is dark on the other side.
  const double g = std::sqrt(0.5);
  HillshadeOptions north_west;
  north_west.azimuth_deg = 315;
  EXPECT_NEAR(shade_all_of(plane(5, 5, g, -g), north_west)(2, 2), 1, 1e-6);
  EXPECT_NEAR(shade_all_of(plane(5, 5, -g, g), north_west)(2, 2), 0, 1e-6);
}

TEST(Hillshade, TheFourLightsStandInTheNorthWest) {
  const double north_west = static_cast<double>(shade_all_of(plane(5, 5, 0.5, -0.5))(2, 2));
  const double south_east = static_cast<double>(shade_all_of(plane(5, 5, -0.5, 0.5))(2, 2));
  const double north_east = static_cast<double>(shade_all_of(plane(5, 5, -0.5, -0.5))(2, 2));
  EXPECT_GT(north_west, north_east + 0.1);
  EXPECT_GT(north_east, south_east + 0.1);
}

TEST(Hillshade, ExaggerationIsTheSameAsHigherTerrain) {
  const Raster<float> low = plane(6, 6, 0.2, 0.1), high = plane(6, 6, 0.4, 0.2);
  EXPECT_NEAR(shade_all_of(low, {2, 45, {}})(3, 3), shade_all_of(high)(3, 3), 1e-6);
}

TEST(Hillshade, AVoidIsVoidAndDarkensNoNeighbour) {
  Raster<float> cells = plane(9, 9, 0.3, 0.2);
  cells(4, 4) = void_value;
  const Raster<float> out = shade_all_of(cells);
  for (std::int64_t y = 0; y < 9; ++y)
    for (std::int64_t x = 0; x < 9; ++x) {
      if (x == 4 && y == 4)
        EXPECT_TRUE(is_void(out(x, y)));
      else
        EXPECT_NEAR(out(x, y), out(0, 0), 1e-6);
    }
}

TEST(Hillshade, IsTheSameByWindowsWithAHaloAndForAnyThreadCount) {
  Raster<float> cells(40, 30);
  for (std::int64_t y = 0; y < 30; ++y)
    for (std::int64_t x = 0; x < 40; ++x)
      cells(x, y) = static_cast<float>(10 * uniform_at(7, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  const Raster<float> whole = shade_all_of(cells, {}, 1);
  const Raster<float> threaded = shade_all_of(cells, {}, 4);
  EXPECT_EQ(std::memcmp(whole.data(), threaded.data(), 40 * 30 * sizeof(float)), 0);
  Raster<float> part(10, 8);
  hillshade(cells.view().sub({14, 9, 12, 10}), {1, 1, 10, 8}, {1, 1}, {}, part.view());
  for (std::int64_t y = 0; y < 8; ++y)
    for (std::int64_t x = 0; x < 10; ++x) EXPECT_EQ(part(x, y), whole(15 + x, 10 + y));
}

}  // namespace
}  // namespace arete
