#include "gis/mesh/mesh_plane.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/mesh/mesh_store.h"

namespace arete {
namespace {

MeshStore mesh_of(const std::vector<MeshVertex>& vertices) {
  MeshStore mesh;
  mesh.append_vertices(vertices);
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}});
  return mesh;
}

TEST(MeshPlane, CoversTheMeshNorthUpInItsOwnUnits) {
  const MeshStore mesh = mesh_of({{100, 50, 7}, {300, 60, 8}, {250, 90, 9}});
  const MeshPlane plane = mesh_plane(mesh, {});
  const std::array<double, 6>& t = *plane.geo.transform;
  EXPECT_NEAR(t[0], 100, 1e-6);
  EXPECT_NEAR(t[3], 90, 1e-6);
  EXPECT_NEAR(t[1] * static_cast<double>(plane.size.width), 200, 1e-6);
  EXPECT_NEAR(t[5] * static_cast<double>(plane.size.height), -40, 1e-6);
  EXPECT_NEAR(plane.cell.x_m * static_cast<double>(plane.size.width), 200, 1e-6);
  EXPECT_NEAR(plane.cell.y_m * static_cast<double>(plane.size.height), 40, 1e-6);
}

TEST(MeshPlane, DegreesAreMeasuredAtTheCentre) {
  MeshFrame frame;
  frame.crs_wkt = crs_wkt("EPSG:4326");
  const MeshPlane plane = mesh_plane(mesh_of({{10, 59.9, 0}, {10.2, 60, 0}, {10.1, 60.1, 0}}), frame);
  // WGS 84 at 60 degrees north: a degree of longitude is 55.800 km, one of latitude 111.412 km.
  EXPECT_NEAR(plane.cell.x_m * static_cast<double>(plane.size.width), 0.2 * 55800, 5);
  EXPECT_NEAR(plane.cell.y_m * static_cast<double>(plane.size.height), 0.2 * 111412, 5);
}

TEST(MeshPlane, GeocentricCoordinatesComeInLongitudeAndLatitude) {
  MeshFrame frame;
  frame.crs_wkt = crs_wkt("EPSG:4978");
  // At the equator: longitudes 0, 0 and 1 degree, latitudes 0, 1 and 0, on the ellipsoid (a = 6378137 m).
  const MeshPlane plane = mesh_plane(mesh_of({{6378137, 0, 0}, {6377172.5, 0, 110568.8}, {6377165.6, 111313.8, 0}}), frame);
  const std::array<double, 6>& t = *plane.geo.transform;
  EXPECT_NEAR(t[0], 0, 1e-4);
  EXPECT_NEAR(t[1] * static_cast<double>(plane.size.width), 1, 1e-3);
  EXPECT_NEAR(t[3], 1, 1e-3);
}

TEST(MeshPlane, RefusesAMeshWithoutExtent) {
  EXPECT_THROW(mesh_plane(mesh_of({{1, 0, 0}, {1, 5, 0}, {1, 9, 3}}), {}), Error);
}

}  // namespace
}  // namespace arete
