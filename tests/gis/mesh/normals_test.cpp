#include "gis/mesh/normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gis/crs.h"
#include "gis/mesh/mesh_store.h"

namespace arete {
namespace {

/// A plane z = a x + b y over a grid, far from the origin.
MeshStore plane(int side, double a, double b) {
  MeshStore mesh;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) mesh.append_vertices(std::vector<MeshVertex>{{500000.0 + x, 5200000.0 + y, a * x + b * y}});
  const std::int64_t n = side;
  for (std::int64_t y = 0; y + 1 < n; ++y)
    for (std::int64_t x = 0; x + 1 < n; ++x) {
      const std::int64_t i = y * n + x;
      mesh.append_triangles(std::vector<MeshTriangle>{{i, i + 1, i + n}, {i + 1, i + n + 1, i + n}});
    }
  return mesh;
}

// The normal of z = a x + b y is (-a, -b, 1) over its length. One ulp of a float below 1 is 6e-8; three roundings.
TEST(VertexNormals, OfAPlaneAreItsNormal) {
  for (const double z_scale : {1.0, 0.3048}) {
    const double a = 0.75, b = -0.5, length = std::sqrt(1 + z_scale * z_scale * (a * a + b * b));
    for (const auto& n : vertex_normals(plane(150, a, b), z_scale)) {
      ASSERT_NEAR(n[0], -a * z_scale / length, 2e-7);
      ASSERT_NEAR(n[1], -b * z_scale / length, 2e-7);
      ASSERT_NEAR(n[2], 1 / length, 2e-7);
    }
  }
}

// Two faces over one edge: a flat one of area 2 and an upright one (normal -x) of area 1; the weights are 2 to 1.
TEST(VertexNormals, WeighFacesByTheirAreas) {
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0, 0, 0}, {0, 1, 0}, {-4, 0, 0}, {0, 0, 2}, {9, 9, 9}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}, {0, 3, 1}});
  const auto normals = vertex_normals(mesh, 1);
  const double length = std::sqrt(5.0);
  for (const int shared : {0, 1}) {
    EXPECT_NEAR(normals[shared][0], -1 / length, 1e-7);
    EXPECT_NEAR(normals[shared][1], 0, 1e-7);
    EXPECT_NEAR(normals[shared][2], 2 / length, 1e-7);
  }
  EXPECT_EQ(normals[2], (std::array<float, 3>{0, 0, 1}));
  EXPECT_EQ(normals[3], (std::array<float, 3>{-1, 0, 0}));
  // No triangle names the last one.
  EXPECT_EQ(normals[4], (std::array<float, 3>{0, 0, 1}));
}

TEST(VertexNormals, OfTrianglesWithoutAreaLookUp) {
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}, {0, 0, 1}});
  for (const auto& normal : vertex_normals(mesh, 1)) EXPECT_EQ(normal, (std::array<float, 3>{0, 0, 1}));
}

TEST(VerticalScale, IsOneUnitOfZInUnitsOfThePlane) {
  constexpr double us_survey_foot = 1200.0 / 3937.0;
  EXPECT_EQ(vertical_scale({"", "ft", 0.3048}), 0.3048);
  EXPECT_EQ(vertical_scale({crs_wkt("EPSG:32632+5773"), "m", 1}), 1);
  EXPECT_EQ(vertical_scale({crs_wkt("EPSG:4978"), "m", 1}), 1);
  // NAD83 / Texas Central (ftUS): metres up are 3.28 feet, feet up are feet.
  EXPECT_NEAR(vertical_scale({crs_wkt("EPSG:2277"), "m", 1}), 1 / us_survey_foot, 1e-9);
  EXPECT_NEAR(vertical_scale({crs_wkt("EPSG:2277+6360"), "ft", us_survey_foot}), 1, 1e-9);
  // A degree of the equator of WGS 84: pi / 180 x 6378137 m = 111319.491 m.
  EXPECT_NEAR(1 / vertical_scale({crs_wkt("EPSG:4326"), "m", 1}), 111319.491, 1e-3);
}

}  // namespace
}  // namespace arete
