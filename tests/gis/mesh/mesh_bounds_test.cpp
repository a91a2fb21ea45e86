#include "gis/mesh/mesh_bounds.h"

#include <gtest/gtest.h>

#include "gis/mesh/mesh_store.h"

namespace arete {
namespace {

TEST(MeshBounds, HoldAllVertices) {
  MeshStore mesh;
  EXPECT_EQ(mesh_bounds(mesh).high, MeshVertex{});
  // More than a block; the extremes lie in different ones.
  for (int i = 0; i < 150000; ++i)
    mesh.append_vertices(std::vector<MeshVertex>{{500.0 + i, -3.0 - i, i == 70000 ? 9.0 : i == 140000 ? -9.0 : 1.0}});
  EXPECT_EQ(mesh_bounds(mesh).low, (MeshVertex{500, -150002, -9}));
  EXPECT_EQ(mesh_bounds(mesh).high, (MeshVertex{150499, -3, 9}));
}

}  // namespace
}  // namespace arete
