#include "gis/mesh/two_dm.h"

#include <gtest/gtest.h>

#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(TwoDm, IsReadFromItsSpecificationAlone) {
  TestFolder folder;
  const MeshStore mesh = hills(40, 450123.456789, 5200000.1);
  MeshWriteOptions options;
  options.title = "\"hills\"";
  write_2dm(mesh, {"", "ft", 0.3048}, folder / "mesh.2dm", options);
  const MeshStore back = read_by_python(folder / "mesh.2dm");
  EXPECT_EQ(vertices_of(back), vertices_of(mesh));
  EXPECT_EQ(triangles_of(back), triangles_of(mesh));
}

TEST(TwoDm, HasTheCardsOfSms) {
  TestFolder folder;
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0.1, 1000000, 1e-9}, {2, 0, 0}, {0, 3, -1e20}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}});
  MeshWriteOptions options;
  options.title = "a \"b\"";
  write_2dm(mesh, {}, folder / "mesh.2dm", options);
  EXPECT_EQ(get_file(folder / "mesh.2dm"),
            "MESH2D\nNUM_MATERIALS_PER_ELEM 1\nMESHNAME \"a 'b'\"\nE3T 1 1 2 3 1\nND 1 0.1 1000000 1e-09\nND 2 2 0 0\nND 3 0 3 "
            "-1e+20\n");
}

TEST(TwoDm, NodesMayHaveGapsAndAnyOrder) {
  TestFolder folder;
  put_file(folder / "mesh.2dm", "MESH2D\nND 1 0 0 0\nND 7 1 0 0\nE3T 3 7 2 1 1\nND 2 0 1 0\nNS 1 2 -7\nBEGPARAMDEF\n");
  const MeshFile file = read_2dm(folder / "mesh.2dm", {});
  EXPECT_EQ(vertices_of(file.mesh), (std::vector<MeshVertex>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{1, 2, 0}}));
}

TEST(TwoDm, WithBadContentsIsRefusedWithTheReason) {
  TestFolder folder;
  const std::string nodes = "MESH2D\nND 1 0 0 0\nND 2 1 0 0\nND 3 0 1 0\n";
  const struct {
    std::string text, expected;
  } cases[] = {{nodes + "E4Q 1 1 2 3 3 1\n", "line 5 holds an element E4Q"},
               {nodes + "E3T 1 1 2 4 1\n", "line 5 names the node 4"},
               {nodes + "E3T 1 1 2\n", "line 5 is no element"},
               {nodes + "ND 2 1 1 1\n", "node 2 a second time"},
               {nodes + "ND 4 1 1\n", "line 5 is no node"},
               {nodes + "ND 4 1 1 nan\n", "line 5 is no node"}};
  for (const auto& bad : cases) {
    put_file(folder / "bad.2dm", bad.text);
    const Error error = error_of([&] { read_2dm(folder / "bad.2dm", {}); });
    EXPECT_EQ(error.kind(), ErrorKind::input) << bad.text;
    EXPECT_NE(std::string(error.what()).find(bad.expected), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace arete
