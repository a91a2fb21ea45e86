#include "gis/mesh/weld_vertices.h"

#include <gtest/gtest.h>

#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(VertexWelder, GivesEqualCoordinatesOneNumberInTheOrderOfTheirFirstUse) {
  MeshBuilder mesh({});
  VertexWelder welder(mesh);
  const auto vertices = vertices_of(hills(150, 450123.456789, 5200000.1));
  for (int round = 0; round < 2; ++round)
    for (std::size_t i = 0; i < vertices.size(); ++i) ASSERT_EQ(welder.index_of(vertices[i]), static_cast<std::int64_t>(i));
  EXPECT_EQ(vertices_of(mesh.finish("")), vertices);
}

TEST(VertexWelder, TakesMinusZeroForZero) {
  MeshBuilder mesh({});
  VertexWelder welder(mesh);
  EXPECT_EQ(welder.index_of({-0.0, 1, -0.0}), 0);
  EXPECT_EQ(welder.index_of({0.0, 1, 0.0}), 0);
  EXPECT_EQ(welder.index_of({0.0, -1, 0.0}), 1);
}

}  // namespace
}  // namespace arete
