#include "gis/mesh/topology.h"

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "tests/gis/mesh/test_mesh.h"

namespace arete {
namespace {

MeshTopology topology_of(const TestMesh& mesh, std::int64_t memory = 1 << 20, std::vector<BorderEdge>* border = nullptr) {
  NoProgress silent;
  return mesh_topology(mesh.store(), memory, silent, border);
}

TestMesh plain_grid(std::int64_t width, std::int64_t height) { return grid_mesh(Raster<float>(width, height, 1.0f).view(), 1); }

TEST(MeshTopology, CountsTheEdgesOfAGrid) {
  std::vector<BorderEdge> border;
  const MeshTopology topology = topology_of(plain_grid(5, 4), 1 << 20, &border);
  // Euler: 20 vertices - E + 24 triangles = 1.
  EXPECT_EQ(topology.edges, 43);
  EXPECT_EQ(topology.border_edges, 14);
  EXPECT_EQ(topology.non_manifold_edges, 0);
  EXPECT_EQ(topology.unused_vertices, 0);
  EXPECT_EQ(topology.components, 1);
  ASSERT_EQ(border.size(), 14u);
  EXPECT_EQ(border.front(), (BorderEdge{1, 0}));  // counter-clockwise: the upper side runs to the left
  EXPECT_EQ(border[1], (BorderEdge{0, 5}));
}

TEST(MeshTopology, IsTheSameInManyPasses) {
  const TestMesh mesh = plain_grid(60, 50);
  std::vector<BorderEdge> border, again;
  const MeshTopology one = topology_of(mesh, 1 << 24, &border), many = topology_of(mesh, 1 << 14, &again);
  EXPECT_EQ(one.edges, many.edges);
  EXPECT_EQ(one.border_edges, 2 * (59 + 49));
  EXPECT_EQ(many.border_edges, one.border_edges);
  EXPECT_EQ(many.non_manifold_edges, 0);
  EXPECT_EQ(border, again);
  // 3000 vertices of 4 bytes do not fit in half of 16 KB.
  EXPECT_EQ(one.components, 1);
  EXPECT_EQ(many.components, std::nullopt);
}

TEST(MeshTopology, SeesPartsAndUnusedVertices) {
  TestMesh mesh = plain_grid(4, 4);
  const auto shift = static_cast<std::int64_t>(mesh.vertices.size());
  const TestMesh other = mesh;
  for (const MeshVertex& v : other.vertices) mesh.vertices.push_back({v.x + 100, v.y, v.z});
  for (const MeshTriangle& t : other.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  mesh.vertices.push_back({500, 500, 0});
  const MeshTopology topology = topology_of(mesh);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(topology.unused_vertices, 1);
}

TEST(MeshTopology, ADuplicatedTriangleIsNotManifold) {
  TestMesh mesh = plain_grid(4, 4);
  mesh.triangles.push_back(mesh.triangles[5]);
  EXPECT_EQ(topology_of(mesh).non_manifold_edges, 3);
}

TEST(MeshTopology, AFlippedTriangleIsNotManifold) {
  TestMesh mesh = plain_grid(5, 5);
  std::swap(mesh.triangles[10][1], mesh.triangles[10][2]);
  EXPECT_EQ(topology_of(mesh).non_manifold_edges, 3);
}

TEST(MeshTopology, ATriangleThatNamesAVertexTwiceHasNoEdges) {
  TestMesh mesh = plain_grid(3, 3);
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(topology_of(mesh).non_manifold_edges, 0);
}

TEST(MeshTopology, RefusesVerticesThatAreNotThere) {
  for (const std::int64_t wrong : {std::int64_t{-1}, std::int64_t{9}, std::int64_t{1} << 62}) {
    TestMesh mesh = plain_grid(3, 3);
    mesh.triangles[2][1] = wrong;
    try {
      topology_of(mesh);
      FAIL() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find("triangle 2 "), std::string::npos) << error.what();
    }
  }
}

TEST(MeshTopology, NoTrianglesAreNoEdges) {
  const MeshTopology topology = topology_of({});
  EXPECT_EQ(topology.edges, 0);
  EXPECT_EQ(topology.components, 0);
}

}  // namespace
}  // namespace arete
