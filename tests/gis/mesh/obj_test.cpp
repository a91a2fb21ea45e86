#include "gis/mesh/obj.h"

#include <CGAL/IO/OBJ.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <sstream>

#include "gis/mesh/mesh_bounds.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

TEST(Obj, IsReadByCgalAndMovedToItsPlaceByTheOffsetFile) {
  TestFolder folder;
  const MeshStore mesh = hills(40, 450123.456789, 5200000.1);
  MeshWriteOptions options;
  options.title = "hills";
  options.normals = true;
  options.texture = "relief.png";
  options.texture_bounds = mesh_bounds(mesh);
  write_obj(mesh, frame_of("EPSG:32632"), folder / "mesh.obj", options);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"mesh.mtl", "mesh.obj", "mesh.prj", "mesh_offset.xyz"}));

  // The middle of 450123.46 ... 450517.36 and of 5200000.1 ... 5200378.24, in whole metres; heights need none.
  EXPECT_EQ(get_file(folder / "mesh_offset.xyz"), "450320 5200189 0\n");
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;
  ASSERT_TRUE(CGAL::IO::read_OBJ(folder / "mesh.obj", points, faces));
  const auto vertices = vertices_of(mesh);
  const auto triangles = triangles_of(mesh);
  ASSERT_EQ(points.size(), vertices.size());
  ASSERT_EQ(faces.size(), triangles.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_LT(std::abs(points[i].x()), 200);
    ASSERT_EQ((MeshVertex{points[i].x() + 450320, points[i].y() + 5200189, points[i].z()}), vertices[i]);
  }
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(faces[i].at(k), static_cast<std::size_t>(triangles[i][k]));
}

TEST(Obj, DrapesATextureOverItsBounds) {
  TestFolder folder;
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{10, 20, 0}, {14, 20, 0}, {10, 28, 1}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}});
  MeshWriteOptions options;
  options.texture = "/elsewhere/relief.png";
  options.texture_bounds = {{10, 20, 0}, {18, 28, 0}};
  write_obj(mesh, {}, folder / "mesh.obj", options);
  EXPECT_EQ(
      get_file(folder / "mesh.obj"),
      "# vertical_unit m = 1 m\n# offset 0 0 0\nmtllib mesh.mtl\nv 10 20 0\nv 14 20 0\nv 10 28 1\nvt 0 0\nvt 0.5 0\nvt 0 1\n"
      "usemtl terrain\nf 1/1 2/2 3/3\n");
  EXPECT_NE(get_file(folder / "mesh.mtl").find("map_Kd relief.png\n"), std::string::npos);
  options.texture.clear();
  options.normals = true;
  write_obj(mesh, {}, folder / "mesh.obj", options);
  EXPECT_NE(get_file(folder / "mesh.obj").find("f 1//1 2//2 3//3\n"), std::string::npos);
}

TEST(Obj, OfOtherProgramsIsReadWithThePix4dOffset) {
  TestFolder folder;
  put_file(folder / "mesh.obj",
           "mtllib x.mtl\r\no thing\r\nv 0.5 0 1 0.2 0.3 0.4\r\nv +1 0 2\r\nv 0 1 3\r\nvn 0 0 1\r\ng a\r\ns off\r\nf -3//1 -2//1 "
           "-1//1\r\nf 1/2/3 2/2/3 3/2/3 \r\n");
  put_file(folder / "mesh_offset.xyz", "327272.000 6166088.000 409.000");
  const MeshFile file = read_obj(folder / "mesh.obj", {});
  EXPECT_EQ(vertices_of(file.mesh),
            (std::vector<MeshVertex>{{327272.5, 6166088, 410}, {327273, 6166088, 411}, {327272, 6166089, 412}}));
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 1, 2}, {0, 1, 2}}));
}

// Another mesh of the same name may have replaced the offset beside it.
TEST(Obj, ItsOwnOffsetComesBeforeTheOneBesideIt) {
  TestFolder folder;
  const MeshStore mesh = hills(3, 450123.456789, 5200000.1);
  write_obj(mesh, {}, folder / "mesh.obj", {});
  put_file(folder / "mesh_offset.xyz", "1 2 3");
  EXPECT_EQ(vertices_of(read_obj(folder / "mesh.obj", {}).mesh), vertices_of(mesh));
}

// Over the origin of a projected system, doubles close to 0 are finer than those far from it: they are rounded to these.
TEST(Obj, RoundsNoMoreThanItSays) {
  TestFolder folder;
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0.1, 1e-9, 0.3}, {500000.1, 3, 0.1}, {0.7, 40000.3, 1e-30}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}});
  write_obj(mesh, {}, folder / "mesh.obj", {});
  const MeshRounding rounding = obj_rounding(mesh_bounds(mesh), {});
  EXPECT_EQ(rounding.vertical, 0);
  // One unit in the last place of 250,000: 2^-35.
  EXPECT_EQ(rounding.horizontal, 0x1p-35);
  const auto back = vertices_of(read_obj(folder / "mesh.obj", {}).mesh), given = vertices_of(mesh);
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    largest = std::max({largest, std::abs(back[i].x - given[i].x), std::abs(back[i].y - given[i].y)});
    EXPECT_EQ(back[i].z, given[i].z);
  }
  EXPECT_GT(largest, 0);
  EXPECT_LE(largest, rounding.horizontal);
}

TEST(Obj, WithBadContentsIsRefusedWithTheReason) {
  TestFolder folder;
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const struct {
    std::string text, expected;
  } cases[] = {{points + "f 1 2 3 1\n", "line 4 holds a face with 4 corners"},
               {points + "f 1 2\n", "2 corners"},
               {points + "f 1 2 4\n", "names vertex 4 of 3"},
               {points + "f 1 2 0\n", "'0'"},
               {points + "f 1 2 -4\n", "'-4'"},
               {points + "f 1 2 x\n", "'x'"},
               {"v 1 2\n", "line 1"},
               {"v 1 2 inf\n", "line 1"},
               {"v 1 2 3\n#" + std::string(70000, 'x'), "line 2 is longer"}};
  for (const auto& bad : cases) {
    put_file(folder / "bad.obj", bad.text);
    const Error error = error_of([&] { read_obj(folder / "bad.obj", {}); });
    EXPECT_EQ(error.kind(), ErrorKind::input) << bad.text.substr(0, 80);
    EXPECT_NE(std::string(error.what()).find(bad.expected), std::string::npos) << error.what();
  }
  put_file(folder / "bad.obj", points);
  put_file(folder / "bad_offset.xyz", "1 2");
  EXPECT_EQ(error_of([&] { read_obj(folder / "bad.obj", {}); }).kind(), ErrorKind::input);
}

}  // namespace
}  // namespace arete
