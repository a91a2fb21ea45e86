#include "gis/tin/placed_mesh.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/mesh/mesh_store.h"

namespace arete {
namespace {

MeshStore one_triangle() {
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0, 0, 100}, {99, 0, 110}, {0, 49.5, 120}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 2, 1}});  // counter-clockwise where rows run south
  return mesh;
}

GeoReference utm() {
  GeoReference geo;
  geo.transform = {450000, 30, 0, 5200000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32632");
  return geo;
}

std::vector<MeshVertex> vertices_of(const MeshSource& mesh) {
  std::vector<MeshVertex> vertices(static_cast<std::size_t>(mesh.vertices()));
  mesh.read_vertices(0, vertices);
  return vertices;
}

/// Twice the signed area in x and y of the first triangle.
double turn(const MeshSource& mesh) {
  std::vector<MeshTriangle> t(1);
  mesh.read_triangles(0, t);
  const std::vector<MeshVertex> v = vertices_of(mesh);
  const MeshVertex &a = v[static_cast<std::size_t>(t[0][0])], &b = v[static_cast<std::size_t>(t[0][1])], &c = v[static_cast<std::size_t>(t[0][2])];
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

constexpr Size size{100, 80};

TEST(PlacedMesh, LiesAtTheCentresOfCells) {
  const MeshStore mesh = one_triangle();
  const PlacedMesh placed(mesh, utm(), size, {});
  const std::vector<MeshVertex> v = vertices_of(placed);
  EXPECT_EQ(v[0], (MeshVertex{450015, 5199985, 100}));
  EXPECT_EQ(v[2], (MeshVertex{450015, 5198500, 120}));
  EXPECT_GT(turn(placed), 0);
  EXPECT_EQ(placed.frame().crs_wkt, utm().crs_wkt);
  EXPECT_EQ(placed.cell_units(), 30);
  EXPECT_FALSE(placed.displacement(1).any());
}

TEST(PlacedMesh, WithoutTransformRowsRunDown) {
  const MeshStore mesh = one_triangle();
  const std::vector<MeshVertex> v = vertices_of(PlacedMesh(mesh, {}, size, {}));
  EXPECT_EQ(v[1], (MeshVertex{99.5, -0.5, 110}));
}

TEST(PlacedMesh, FacesTheSkyInAMirroredRaster) {
  const MeshStore mesh = one_triangle();
  GeoReference geo = utm();
  geo.transform = {450000, 30, 0, 5200000, 0, 30};
  EXPECT_GT(turn(PlacedMesh(mesh, geo, size, {})), 0);
}

TEST(PlacedMesh, FeetStayFeet) {
  const MeshStore mesh = one_triangle();
  GeoReference geo = utm();
  geo.vertical_unit = "ft";
  geo.metres_per_unit = 0.3048;
  EXPECT_DOUBLE_EQ(vertices_of(PlacedMesh(mesh, geo, size, {}))[0].z, 100 / 0.3048);
  const PlacedMesh metric(mesh, geo, size, {"", true});
  EXPECT_EQ(vertices_of(metric)[0].z, 100);
  EXPECT_EQ(metric.frame().metres_per_unit, 1);
}

TEST(PlacedMesh, DegreesBecomeTheirUtmZoneForMetricFormats) {
  const MeshStore mesh = one_triangle();
  GeoReference geo;
  geo.transform = {-35.0, 1.0 / 3600, 0, -8.0, 0, -1.0 / 3600};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  const PlacedMesh placed(mesh, geo, size, {"", true});
  EXPECT_EQ(summarise_crs(placed.frame().crs_wkt).authority, "EPSG:32725");
  EXPECT_NEAR(placed.cell_units(), 30.7, 0.3);
  EXPECT_GT(turn(placed), 0);
  const Displacement moved = placed.displacement(1);
  EXPECT_GT(moved.bend_cells, 0);
  EXPECT_LT(moved.bend_cells * moved.longest_cells * moved.longest_cells, 0.2501);
}

TEST(PlacedMesh, GeocentricCoordinatesAreRight) {
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{-0.5, -0.5, 1000}});
  GeoReference geo;
  geo.transform = {90, 0.001, 0, 0, 0, -0.001};  // on the equator: X = 0, Y = a + h
  geo.crs_wkt = crs_wkt("EPSG:4326");
  const PlacedMesh placed(mesh, geo, size, {crs_wkt("EPSG:4978"), false});
  const MeshVertex v = vertices_of(placed)[0];
  EXPECT_NEAR(v.x, 0, 1e-6);
  EXPECT_NEAR(v.y, 6378137 + 1000, 1e-6);
  EXPECT_NEAR(v.z, 0, 1e-6);
  // A chord of L metres sags L² / 8 R below the ellipsoid; a cell is 111 m.
  EXPECT_NEAR(placed.displacement(1).sag_m, 1.5 * 111.3 * 111.3 / 8 / 6378137, 2e-5);
}

TEST(PlacedMesh, RefusesAPlaneThatTheRasterCannotBeIn) {
  const MeshStore mesh = one_triangle();
  EXPECT_THROW(PlacedMesh(mesh, {}, size, {crs_wkt("EPSG:32632"), false}), Error);
}

}  // namespace
}  // namespace arete
