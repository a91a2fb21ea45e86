#include "core/terrain/sky_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

/// Steepest rise along one ray, the slow way, by the definition in the header.
double look(const Raster<float>& cells, CellSize cell, double azimuth_deg, std::int64_t x, std::int64_t y) {
  const double azimuth = azimuth_deg * M_PI / 180, columns = std::sin(azimuth) / cell.x_m, rows = -std::cos(azimuth) / cell.y_m;
  const bool by_columns = std::abs(columns) >= std::abs(rows);
  const double shift = by_columns ? rows / columns : columns / rows, step_m = 1 / std::max(std::abs(columns), std::abs(rows));
  const std::int64_t forward = (by_columns ? columns : rows) > 0 ? 1 : -1;
  const std::int64_t major = by_columns ? x : y, length = by_columns ? cells.width() : cells.height(), breadth = by_columns ? cells.height() : cells.width();
  const std::int64_t start = (by_columns ? y : x) - std::llround(shift * static_cast<double>(major));
  const auto height = [&](std::int64_t i) {
    const double minor = std::min(std::max(0.0, static_cast<double>(start) + shift * static_cast<double>(i)), static_cast<double>(breadth - 1));
    const auto low = static_cast<std::int64_t>(minor), high = std::min(low + 1, breadth - 1);
    const double a = by_columns ? cells(i, low) : cells(low, i), b = by_columns ? cells(i, high) : cells(high, i);
    return a + (minor - static_cast<double>(low)) * (b - a);
  };
  double steepest = 0;
  for (std::int64_t i = major + forward; i >= 0 && i < length; i += forward) {
    const std::int64_t minor = start + std::llround(shift * static_cast<double>(i));
    if (minor < 0 || minor >= breadth) break;
    steepest = std::max(steepest, (height(i) - height(major)) / (step_m * static_cast<double>(std::abs(i - major))));
  }
  return steepest;
}

Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = static_cast<float>(30 * uniform_at(7, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  return cells;
}

TEST(SkyLight, TheHorizonIsTheSteepestRiseAlongEachRay) {
  const Raster<float> cells = rough(23, 17);
  const CellSize cell{30, 20};
  for (const double azimuth : {0.0, 22.5, 45.0, 90.0, 111.0, 180.0, 263.0, 270.0, 337.5}) {
    const Raster<float> found = horizon(cells.view(), cell, azimuth, 2);
    for (std::int64_t y = 0; y < 17; ++y)
      for (std::int64_t x = 0; x < 23; ++x) EXPECT_NEAR(found(x, y), look(cells, cell, azimuth, x, y), 1e-5) << azimuth << ": " << x << ", " << y;
  }
}

TEST(SkyLight, APlainSeesAllOfIt) {
  const SkyLight light = measure_sky_light(Raster<float>(9, 7, 5.0f).view(), {10, 10});
  for (int i = 0; i < 63; ++i) {
    EXPECT_FLOAT_EQ(light.sky.data()[i], 1);
    EXPECT_FLOAT_EQ(light.sun.data()[i], 1);
  }
}

TEST(SkyLight, AWallThrowsAShadowOfItsLength) {
  Raster<float> cells(60, 5, 0.0f);
  for (std::int64_t y = 0; y < 5; ++y) cells(10, y) = 20;
  // From the west at atan(1/2): 20 m of wall shade 40 m of ground, 20 m when the heights are halved.
  SkyLightOptions options{.sun_azimuth_deg = 270, .sun_elevation_deg = std::atan(0.5) * 180 / M_PI, .sun_width_deg = 1e-3};
  const auto shaded = [&] {
    const SkyLight light = measure_sky_light(cells.view(), {1, 1}, options);
    int count = 0;
    for (std::int64_t x = 11; x < 60; ++x) count += light.sun(x, 2) < 0.25f;
    EXPECT_EQ(light.sun(5, 2), 1);
    return count;
  };
  EXPECT_EQ(shaded(), 39);  // the 40th metre sees half of the sun
  options.exaggeration = 0.5;
  EXPECT_EQ(shaded(), 19);
}

TEST(SkyLight, TheBottomOfAPitSeesACap) {
  // A round pit of radius 200 m and depth 200 m: the horizon is at 45 degrees all round, cos^2 of which is a half.
  Raster<float> cells(501, 501);
  for (std::int64_t y = 0; y < 501; ++y)
    for (std::int64_t x = 0; x < 501; ++x) cells(x, y) = std::hypot(static_cast<double>(x - 250), static_cast<double>(y - 250)) >= 200 ? 200.0f : 0.0f;
  EXPECT_NEAR(measure_sky_light(cells.view(), {1, 1}).sky(250, 250), 0.5, 0.005);
}

TEST(SkyLight, DoesNotDependOnThreads) {
  const Raster<float> cells = rough(200, 300);
  const SkyLight one = measure_sky_light(cells.view(), {30, 30}, {.threads = 1}), many = measure_sky_light(cells.view(), {30, 30}, {.threads = 5});
  for (int i = 0; i < 60000; ++i) {
    ASSERT_EQ(one.sky.data()[i], many.sky.data()[i]);
    ASSERT_EQ(one.sun.data()[i], many.sun.data()[i]);
  }
}

}  // namespace
}  // namespace arete
