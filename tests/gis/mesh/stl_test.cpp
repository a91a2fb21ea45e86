#include "gis/mesh/stl.h"

#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <cstring>

#include "gis/mesh/mesh_bounds.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

TEST(Stl, IsReadByCgalWithinItsRounding) {
  TestFolder folder;
  const MeshStore mesh = hills(40, 450123.456789, 5200000.1, 1500);
  write_stl(mesh, frame_of("EPSG:32632"), folder / "mesh.stl", {});
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"mesh.prj", "mesh.stl", "mesh_offset.xyz"}));
  EXPECT_EQ(get_file(folder / "mesh_offset.xyz"), "450320 5200189 0\n");
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;
  ASSERT_TRUE(CGAL::IO::read_STL(folder / "mesh.stl", points, faces));
  const auto corners = corners_of(mesh);
  const MeshRounding rounding = stl_rounding(mesh_bounds(mesh), {});
  // Half a unit in the last place of 197 and of 1600.3, and what is left of a double.
  EXPECT_NEAR(rounding.horizontal, 0x1p-17, 2e-9);
  EXPECT_NEAR(rounding.vertical, 0x1p-14, 2e-9);
  ASSERT_EQ(faces.size() * 3, corners.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& p = points[faces[i].at(k)];
      ASSERT_NEAR(p.x() + 450320, corners[3 * i + k].x, rounding.horizontal);
      ASSERT_NEAR(p.y() + 5200189, corners[3 * i + k].y, rounding.horizontal);
      ASSERT_NEAR(p.z(), corners[3 * i + k].z, rounding.vertical);
    }
}

// Multiples of 2^-10 within 8192 of the offset take 23 bits: a float32 holds 24.
TEST(Stl, HoldsMillimetreFractionsExactly) {
  TestFolder folder;
  MeshStore mesh;
  for (int i = 0; i < 300; ++i)
    mesh.append_vertices(
        std::vector<MeshVertex>{{500000 + 27.0 * i, 4000000 + 1025.0 / 1024 * i, -8192 + 16384.0 / 1024 * i + 1.0 / 1024}});
  for (std::int64_t i = 0; i + 2 < 300; ++i) mesh.append_triangles(std::vector<MeshTriangle>{{i, i + 1, i + 2}});
  write_stl(mesh, {}, folder / "mesh.stl", {});
  const MeshFile back = read_stl(folder / "mesh.stl", {});
  EXPECT_EQ(vertices_of(back.mesh), vertices_of(mesh));
  EXPECT_EQ(triangles_of(back.mesh), triangles_of(mesh));
}

TEST(Stl, HasTheLayoutOfItsSpecification) {
  TestFolder folder;
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}, {0, 0, 1}});
  write_stl(mesh, {}, folder / "mesh.stl", {});
  const std::string bytes = get_file(folder / "mesh.stl");
  ASSERT_EQ(bytes.size(), 84u + 2 * 50);
  EXPECT_EQ(bytes.substr(0, 20), "Arete; offset 0 0 0 ");
  EXPECT_EQ(bytes.substr(80, 4), std::string("\2\0\0\0", 4));
  std::array<float, 12> facet{};
  std::memcpy(facet.data(), bytes.data() + 84, sizeof facet);
  EXPECT_EQ(facet, (std::array<float, 12>{0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0}));
  // A triangle without area has no normal.
  std::memcpy(facet.data(), bytes.data() + 134, 12);
  EXPECT_EQ((std::array<float, 3>{facet[0], facet[1], facet[2]}), (std::array<float, 3>{0, 0, 0}));
}

TEST(Stl, AsTextIsRead) {
  TestFolder folder;
  const std::string facet =
      "facet normal 0 0 1\n outer loop\n  vertex 0 0 1.5\n  vertex 1 0 0\n  vertex 0 1e0 0\n endloop\nendfacet\n"
      "facet normal 0 0 1\n outer loop\n  vertex 1 0 0\n  vertex 1 1 0\n  vertex 0 1 -0\n endloop\nendfacet\n";
  put_file(folder / "mesh.stl", "solid name\n" + facet + "endsolid name\n\n");
  const MeshFile file = read_stl(folder / "mesh.stl", {});
  EXPECT_EQ(vertices_of(file.mesh), (std::vector<MeshVertex>{{0, 0, 1.5}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 1, 2}, {1, 3, 2}}));
  for (const std::string& bad : {"solid x\n" + facet, std::string("solid x\nfacet\nvertex 0 0 0\nendfacet\nendsolid\n"),
                                 std::string("solid x\nvertex 0 0\nendsolid\n"),
                                 std::string("solid x\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nendsolid\n")}) {
    put_file(folder / "mesh.stl", bad);
    EXPECT_EQ(error_of([&] { read_stl(folder / "mesh.stl", {}); }).kind(), ErrorKind::input) << bad;
  }
}

struct Endless final : MeshSource {
  std::int64_t vertices() const override { return 3; }
  std::int64_t triangles() const override { return std::int64_t{1} << 32; }
  void read_vertices(std::int64_t, std::span<MeshVertex>) const override { FAIL(); }
  void read_triangles(std::int64_t, std::span<MeshTriangle>) const override { FAIL(); }
};

TEST(Stl, SaysItsLimit) {
  TestFolder folder;
  EXPECT_EQ(error_of([&] { write_stl(Endless(), {}, folder / "mesh.stl", {}); }).kind(), ErrorKind::format);
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace arete
