#include "gis/mesh/mesh_builder.h"

#include <gtest/gtest.h>

#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(MeshBuilder, GivesWhatWasAddedInMemoryOrOnDisk) {
  TestFolder folder;
  const MeshStore hilly = hills(300, 0, 0);
  for (const Scratch& scratch : {Scratch{}, Scratch{1 << 20, folder.path()}}) {
    MeshBuilder mesh(scratch);
    for (const MeshTriangle& triangle : triangles_of(hilly)) mesh.add(triangle);
    std::int64_t index = 0;
    for (const MeshVertex& vertex : vertices_of(hilly)) ASSERT_EQ(mesh.add(vertex), index++);
    const MeshStore built = mesh.finish("");
    EXPECT_EQ(vertices_of(built), vertices_of(hilly));
    EXPECT_EQ(triangles_of(built), triangles_of(hilly));
  }
}

TEST(MeshBuilder, RefusesTrianglesOfVerticesThatAreNotThere) {
  for (const std::int64_t bad : {-1, 3}) {
    MeshBuilder mesh({});
    for (int i = 0; i < 3; ++i) mesh.add(MeshVertex{});
    mesh.add(MeshTriangle{0, 1, 2});
    mesh.add(MeshTriangle{0, bad, 2});
    const Error error = error_of([&] { mesh.finish("file.ply"); });
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("'file.ply'"), std::string::npos);
  }
}

TEST(PointNumbers, WithAndWithoutGaps) {
  PointNumbers numbers;
  for (const std::int64_t number : {1, 2, 5, 3, 4, -7}) EXPECT_TRUE(numbers.add(number));
  for (const std::int64_t number : {1, 2, 5, 3, 4, -7}) EXPECT_FALSE(numbers.add(number));
  EXPECT_EQ(numbers.place_of(2), 1);
  EXPECT_EQ(numbers.place_of(5), 2);
  EXPECT_EQ(numbers.place_of(3), 3);
  EXPECT_EQ(numbers.place_of(-7), 5);
  EXPECT_EQ(numbers.place_of(0), -1);
  EXPECT_TRUE(numbers.add(6));
  EXPECT_EQ(numbers.place_of(6), 6);
}

}  // namespace
}  // namespace arete
