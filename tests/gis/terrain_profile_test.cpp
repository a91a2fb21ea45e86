#include "gis/terrain_profile.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/geodesy.h"

namespace arete {
namespace {

Raster<float> ramp_raster() {
  Raster<float> cells(50, 40);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 50; ++x) cells(x, y) = static_cast<float>(100 + 4 * x + 2 * y);
  return cells;
}

GeoReference utm(double step) {
  GeoReference geo;
  geo.transform = {500000, step, 0, 4600000, 0, -step};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  return geo;
}

TEST(TerrainProfile, FollowsAPlaneExactly) {
  const Raster<float> cells = ramp_raster();
  const GeoReference geo = utm(30);
  // From cell (5, 30) to cell (45, 10), centre to centre.
  const MapLine line{{500000 + 5.5 * 30, 4600000 - 30.5 * 30}, {500000 + 45.5 * 30, 4600000 - 10.5 * 30}};
  const std::vector<ProfilePoint> points = sample_profile(ViewSource(cells.view()), geo, line);
  ASSERT_GE(points.size(), 89U) << "two for each of 44.7 cells";
  EXPECT_EQ(points.front().distance_m, 0);
  EXPECT_NEAR(points.back().distance_m, 30 * std::hypot(40, 20), 1e-6);
  for (const ProfilePoint& p : points) {
    const double share = p.distance_m / points.back().distance_m;
    EXPECT_NEAR(p.elevation_m, 100 + 4 * (5 + 40 * share) + 2 * (30 - 20 * share), 1e-4);
  }
}

TEST(TerrainProfile, DistancesInDegreesAreGeodesic) {
  Raster<float> cells(100, 100);
  GeoReference geo;
  geo.transform = {10, 0.01, 0, 60, 0, -0.01};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  const std::vector<ProfilePoint> points = sample_profile(ViewSource(cells.view()), geo, {{10.5, 60}, {10.5, 59}});
  // One degree of the meridian of WGS 84 from 59 to 60 north.
  EXPECT_NEAR(points.back().distance_m, 111403.6, 1);
  EXPECT_NEAR(distances_along(geo, {{10, 60}, {11, 60}}).back(), 55800.3, 1);
}

TEST(TerrainProfile, IsVoidWhereTheRasterIsOrEnds) {
  Raster<float> cells = ramp_raster();
  for (std::int64_t y = 0; y < 40; ++y) cells(20, y) = void_value;
  const GeoReference geo = utm(1);
  const std::vector<ProfilePoint> points = sample_profile(ViewSource(cells.view()), geo, {{499990, 4599980.5}, {500050, 4599980.5}});
  for (const ProfilePoint& p : points) {
    const double column = p.distance_m - 10;
    if (std::abs(column - std::round(column)) < 1e-6) continue;
    EXPECT_EQ(std::isnan(p.elevation_m), column < 0 || (column > 20 && column < 21)) << column;
  }
}

TEST(TerrainProfile, TheMiddleLineCrossesTheRaster) {
  const MapLine line = middle_line(utm(10), {50, 40});
  EXPECT_EQ(line.from, (std::array<double, 2>{500000, 4599800}));
  EXPECT_EQ(line.to, (std::array<double, 2>{500500, 4599800}));
}

TEST(TerrainProfile, RefusesALineWithoutLength) {
  const Raster<float> cells = ramp_raster();
  EXPECT_THROW(sample_profile(ViewSource(cells.view()), utm(1), {{500010, 4599990}, {500010, 4599990}}), Error);
  EXPECT_THROW(sample_profile(ViewSource(cells.view()), utm(1), {{NAN, 0}, {1, 1}}), Error);
}

/// Where the ground begins in a column of pixels: the first dark one below the frame's top.
std::int64_t top_of_ground(const Picture& picture, std::int64_t x) {
  for (std::int64_t y = 60; y < picture.height(); ++y)
    if (picture(x, y)[0] < 120 && picture(x, y)[1] < 120) return y;
  return -1;
}

TEST(DrawProfile, HasTheExaggerationThatItSays) {
  // A slope of 45 degrees over 1 km.
  std::vector<ProfilePoint> points;
  for (int i = 0; i <= 100; ++i) points.push_back({10.0 * i, 5.0 * i});
  const ColourRamp ramp = named_ramp("grey");
  for (const double exaggeration : {0.25, 0.5}) {
    const DrawnProfile drawn = draw_profile(points, ramp, {"", 1600, 640, exaggeration});
    EXPECT_EQ(drawn.exaggeration, exaggeration);
    const double fall = static_cast<double>(top_of_ground(drawn.picture, 700) - top_of_ground(drawn.picture, 1100)) / 400;
    EXPECT_NEAR(fall, 0.5 * exaggeration, 0.01);
  }
  EXPECT_GT(draw_profile(points, ramp, {}).exaggeration, 0.3);
  EXPECT_THROW(draw_profile(points, ramp, {"", 1600, 640, 100}), Error);
  EXPECT_THROW(draw_profile({{0, NAN}, {10, NAN}}, ramp, {}), Error);
}

}  // namespace
}  // namespace arete
