#include "gis/mesh/seams.h"

#include <gtest/gtest.h>

#include "tests/gis/mesh/test_mesh.h"

namespace arete {
namespace {

struct Seams {
  MeshFault t_junctions, cracks;
};

Seams seams_of(const TestMesh& mesh) {
  NoProgress silent;
  const MeshStore store = mesh.store();
  RasterPoints points(store, RasterPlane({}, {}), {}, std::int64_t{1} << 30, silent);
  std::vector<BorderEdge> border;
  mesh_topology(store, std::int64_t{1} << 30, silent, &border);
  return {find_t_junctions(border, points), find_cracks(border, points)};
}

TEST(FindTJunctions, AGridHasNone) {
  const Seams seams = seams_of(grid_mesh(Raster<float>(20, 30, 1.0f).view(), 3));
  EXPECT_EQ(seams.t_junctions.count, 0);
  EXPECT_EQ(seams.cracks.count, 0);
}

TEST(FindCracks, FindsTwoPartsSideBySide) {
  TestMesh mesh;
  mesh.vertices = {{0, 0, 0}, {8, 0, 0}, {0, -8, 0}, {8, 0, 3}, {0, -8, 3}, {8, -8, 3}};
  mesh.triangles = {{0, 2, 1}, {3, 4, 5}};
  EXPECT_EQ(seams_of(mesh).cracks.count, 1);
}

TEST(FindCracks, TwoPartsThatTouchAtACornerHaveNone) {
  TestMesh mesh;
  mesh.vertices = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {8, 0, 0}, {16, 0, 0}, {8, -8, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
  EXPECT_EQ(seams_of(mesh).cracks.count, 0);
}

/// A triangle whose long side meets two that share a vertex in its middle.
TestMesh crack(double x0, double y0, double x1, double y1) {
  TestMesh mesh;
  const double mx = (x0 + x1) / 2, my = (y0 + y1) / 2, nx = -(y1 - y0) / 2, ny = (x1 - x0) / 2;
  mesh.vertices = {{x0, y0, 0}, {x1, y1, 0}, {mx + nx, my + ny, 0}, {mx, my, 0}, {mx - nx, my - ny, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}};
  return mesh;
}

TEST(FindTJunctions, FindsACrackInAnyDirection) {
  for (const auto& [x, y] : {std::pair{80.0, 0.0}, {0.0, 80.0}, {64.0, 32.0}, {-64.0, 32.0}, {-8.0, -1024.0}, {1000.0, -8.0}, {0.25, 0.5}}) {
    const Seams seams = seams_of(crack(2000, -3000, 2000 + x, -3000 + y));
    EXPECT_EQ(seams.t_junctions.count, 1) << x << ' ' << y;
    EXPECT_EQ(seams.t_junctions.first, 3);
  }
}

TEST(FindTJunctions, AVertexBesideTheEdgeIsNone) {
  TestMesh mesh = crack(2000, -3000, 2064, -2968);
  mesh.vertices[3].y -= 0x1p-18;
  EXPECT_EQ(seams_of(mesh).t_junctions.count, 0);
}

}  // namespace
}  // namespace arete
