#include "gis/mesh/measure_mesh.h"

#include <cmath>

#include <GeographicLib/PolygonArea.hpp>
#include <gtest/gtest.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "tests/gis/mesh/test_mesh.h"

namespace arete {
namespace {

MeshMeasures measures_of(const TestMesh& mesh, const std::string& crs, double metres_per_unit = 1) {
  NoProgress silent;
  MeshFrame frame;
  if (!crs.empty()) frame.crs_wkt = crs_wkt(crs);
  frame.metres_per_unit = metres_per_unit;
  return measure_mesh(mesh.store(), frame, silent);
}

TestMesh grid_over(double west, double north, double cell) {
  Raster<float> dem(101, 51, 7.0f);
  dem(3, 4) = 2;
  GeoReference geo;
  geo.transform = {west, cell, 0, north, 0, -cell};
  return grid_mesh(dem.view(), 1, geo);
}

TEST(MeasureMesh, AProjectedMeshHasTheAreaOfItsPlane) {
  const MeshMeasures measures = measures_of(grid_over(500000, 4600000, 10), "EPSG:32633", 0.5);
  EXPECT_EQ(measures.bounds.low, (MeshVertex{500005, 4600000 - 505, 2}));
  EXPECT_EQ(measures.bounds.high, (MeshVertex{501005, 4599995, 7}));
  EXPECT_EQ(measures.low_m, 1);
  EXPECT_EQ(measures.high_m, 3.5);
  EXPECT_DOUBLE_EQ(measures.area_m2, 1000.0 * 500);
  EXPECT_DOUBLE_EQ(measures_of(grid_over(500000, 4600000, 10), "").area_m2, 1000.0 * 500);
}

TEST(MeasureMesh, FeetAreNotMetres) {
  const double foot = 1200.0 / 3937;
  EXPECT_NEAR(measures_of(grid_over(500000, 460000, 10), "EPSG:2225").area_m2, 1000 * 500 * foot * foot, 1e-3);
}

TEST(MeasureMesh, AGeographicMeshHasTheAreaOnTheEllipsoid) {
  // The authority: GeographicLib's geodesic polygon along the parallels, vertex by vertex.
  const double west = 9, north = 47, cell = 0.01;
  GeographicLib::PolygonArea polygon(GeographicLib::Geodesic::WGS84());
  const auto corner = [&](int column, int row) { polygon.AddPoint(north - (row + 0.5) * cell, west + (column + 0.5) * cell); };
  for (int i = 0; i < 50; ++i) corner(0, i);
  for (int i = 0; i < 100; ++i) corner(i, 50);
  for (int i = 50; i > 0; --i) corner(100, i);
  for (int i = 100; i > 0; --i) corner(i, 0);
  double perimeter = 0, area = 0;
  polygon.Compute(false, true, perimeter, area);
  EXPECT_NEAR(measures_of(grid_over(west, north, cell), "EPSG:4326").area_m2 / area, 1, 1e-7);
}

TEST(MeasureMesh, GeocentricTrianglesAreMeasuredInSpace) {
  TestMesh mesh;
  mesh.vertices = {{6378137, 0, 0}, {6378137, 300, 0}, {6378137, 0, 400}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_DOUBLE_EQ(measures_of(mesh, "EPSG:4978").area_m2, 60000);
}

TEST(MeasureMesh, NothingHasNoArea) {
  const MeshMeasures measures = measures_of({}, "");
  EXPECT_EQ(measures.area_m2, 0);
  EXPECT_EQ(measures.bounds.high, MeshVertex{});
}

TEST(MeasureMesh, RefusesVerticesThatAreNotThere) {
  TestMesh mesh = grid_over(0, 0, 1);
  mesh.triangles[4][0] = -1;
  EXPECT_THROW(measures_of(mesh, ""), Error);
}

}  // namespace
}  // namespace arete
