#include "gis/mesh/draw_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/gis/mesh/test_mesh.h"

namespace arete {
namespace {

GeoReference utm() {
  GeoReference geo;
  geo.transform = {500000, 30, 0, 4600000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32633");
  return geo;
}

MeshDrawOptions plain(std::int64_t width, bool wireframe) {
  MeshDrawOptions options;
  options.relief.width = width;
  options.relief.legend = false;
  options.wireframe = wireframe;
  return options;
}

Relief drawn(const TestMesh& mesh, const std::string& crs, const MeshDrawOptions& options) {
  NoProgress silent;
  MeshFrame frame;
  frame.crs_wkt = crs;
  return draw_mesh(mesh.store(), frame, options, silent);
}

Raster<float> hills(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = static_cast<float>(500 + 200 * std::sin(static_cast<double>(x) / 9) * std::cos(static_cast<double>(y) / 7));
  return cells;
}

double brightness(Colour c) { return (c[0] + c[1] + c[2]) / 3.0; }

// draw_relief of the same heights is the authority.
TEST(DrawMesh, LooksAsTheReliefOfItsHeights) {
  const Raster<float> dem = hills(201, 101);
  const Relief mesh = drawn(grid_mesh(dem.view(), 1, utm()), utm().crs_wkt, plain(800, false));
  EXPECT_EQ(mesh.picture.width(), 800);
  EXPECT_EQ(mesh.picture.height(), 400);
  EXPECT_NEAR(mesh.metres_per_pixel, 7.5, 1e-9);
  EXPECT_NEAR(mesh.low_m, 300, 1);
  EXPECT_NEAR(mesh.high_m, 700, 1);
  // Heights at the centres of pixels of 7.5 m, between the outermost centres of cells.
  Raster<float> fine(800, 400);
  for (std::int64_t y = 0; y < 400; ++y)
    for (std::int64_t x = 0; x < 800; ++x) {
      const double u = (static_cast<double>(x) + 0.5) / 4, v = (static_cast<double>(y) + 0.5) / 4;
      fine(x, y) = static_cast<float>(500 + 200 * std::sin(u / 9) * std::cos(v / 7));
    }
  NoProgress silent;
  ReliefOptions options;
  options.legend = false;
  options.width = 800;
  options.exaggeration = mesh.exaggeration;
  const Picture relief = draw_relief(ViewSource(fine.view()), {7.5, 7.5}, options, silent).picture;
  double sum = 0;
  for (std::int64_t i = 0; i < 800 * 400; ++i) sum += std::fabs(brightness(relief.data()[i]) - brightness(mesh.picture.data()[i]));
  EXPECT_LT(sum / (800 * 400), 4);
}

TEST(DrawMesh, WhatNoTriangleCoversIsHatched) {
  TestMesh mesh = grid_mesh(hills(41, 41).view(), 40, utm());
  mesh.triangles.pop_back();
  const Picture picture = drawn(mesh, utm().crs_wkt, plain(200, false)).picture, whole = drawn(grid_mesh(hills(41, 41).view(), 40, utm()), utm().crs_wkt, plain(200, false)).picture;
  EXPECT_GT(brightness(picture(150, 150)), 200);
  EXPECT_LT(brightness(whole(150, 150)), 225);
  EXPECT_NE(picture(150, 150), whole(150, 150));
}

TEST(DrawMesh, LinesFollowTheSidesOfTheTriangles) {
  const TestMesh mesh = grid_mesh(Raster<float>(41, 41, 100.0f).view(), 20, utm());
  const Picture bare = drawn(mesh, utm().crs_wkt, plain(400, false)).picture, lined = drawn(mesh, utm().crs_wkt, plain(400, true)).picture;
  // 20 cells are 200 pixels; diagonals run from the lower left to the upper right.
  const auto darker = [&](std::int64_t x, std::int64_t y) { return brightness(bare(x, y)) - brightness(lined(x, y)); };
  for (std::int64_t i = 20; i < 370; ++i) {
    if (std::abs(i % 200 - 95) > 75) continue;
    EXPECT_GT(darker(i, 200), 20) << i;
    EXPECT_GT(darker(200, i), 20) << i;
    EXPECT_GT(darker(i, 199 - i % 200), 20) << i;
    EXPECT_EQ(darker(i, 190 - i % 200), 0) << i;
  }
}

TEST(DrawMesh, DenseLinesDoNotHideTheRelief) {
  const TestMesh mesh = grid_mesh(hills(301, 301).view(), 1, utm());
  const Picture bare = drawn(mesh, utm().crs_wkt, plain(300, false)).picture, lined = drawn(mesh, utm().crs_wkt, plain(300, true)).picture;
  double before = 0, after = 0;
  for (std::int64_t i = 0; i < 300 * 300; ++i) before += brightness(bare.data()[i]), after += brightness(lined.data()[i]);
  EXPECT_LT(after, before);
  EXPECT_GT(after, 0.8 * before);
}

TEST(DrawMesh, GeocentricCoordinatesAreDrawnFromAbove) {
  GeoReference geo;
  geo.transform = {9.6, 1.0 / 3600, 0, 47.1, 0, -1.0 / 3600};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  const TestMesh mesh = grid_mesh(hills(120, 90).view(), 3, geo);
  TestMesh turned = mesh;
  OGRSpatialReference from, to;
  from.importFromEPSG(4979);
  to.importFromEPSG(4978);
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> change(OGRCreateCoordinateTransformation(&from, &to));
  for (MeshVertex& v : turned.vertices) ASSERT_TRUE(change->Transform(1, &v.x, &v.y, &v.z));
  const Relief flat = drawn(mesh, geo.crs_wkt, plain(300, true)), round = drawn(turned, crs_wkt("EPSG:4978"), plain(300, true));
  // One second of longitude is cos(latitude) of one of latitude.
  EXPECT_NEAR(static_cast<double>(flat.picture.height()), 300 * 89.0 / 119 / std::cos(47.09 * M_PI / 180), 3);
  ASSERT_EQ(round.picture.height(), flat.picture.height());
  std::int64_t differ = 0;
  for (std::int64_t i = 0; i < 300 * flat.picture.height(); ++i) differ += std::fabs(brightness(round.picture.data()[i]) - brightness(flat.picture.data()[i])) > 8;
  EXPECT_LT(differ, 300);
}

TEST(DrawMesh, RefusesWhatHasNoExtent) {
  TestMesh mesh = grid_mesh(hills(5, 5).view(), 1, utm());
  for (MeshVertex& v : mesh.vertices) v.x = 500000;
  EXPECT_THROW(drawn(mesh, utm().crs_wkt, plain(100, true)), Error);
  EXPECT_THROW(drawn({}, utm().crs_wkt, plain(100, true)), Error);
}

TEST(DrawMesh, DrawsARealMesh) {
  const std::string path = test_data("davosdorf_dtm_10m.tif");
  if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  const DemReader reader(path);
  const Raster<float> dem = read_all(reader);
  const Relief relief = drawn(grid_mesh(dem.view(), 8, reader.georeference()), reader.georeference().crs_wkt, MeshDrawOptions{});
  EXPECT_EQ(std::max(relief.picture.width(), std::int64_t{2048}), 2048);
  EXPECT_NEAR(relief.low_m, 1535.92, 20);
  EXPECT_NEAR(relief.high_m, 2843.08, 60);
  // To look at: ARETE_TEST_PICTURES names a folder.
  if (const char* folder = std::getenv("ARETE_TEST_PICTURES")) write_picture(std::string(folder) + "/davosdorf.png", relief.picture, true);
}

}  // namespace
}  // namespace arete
