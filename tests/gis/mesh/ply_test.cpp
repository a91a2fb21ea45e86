#include "gis/mesh/ply.h"

#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "gis/mesh/normals.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

TEST(Ply, IsReadByCgal) {
  TestFolder folder;
  const MeshStore mesh = hills(40, 450123.456789, 5200000.1);
  MeshWriteOptions options;
  options.title = "hills";
  for (const bool normals : {false, true}) {
    options.normals = normals;
    write_ply(mesh, frame_of("EPSG:32632"), folder / "mesh.ply", options);
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> faces;
    ASSERT_TRUE(CGAL::IO::read_PLY(folder / "mesh.ply", points, faces, CGAL::parameters::use_binary_mode(true)));
    const auto vertices = vertices_of(mesh);
    const auto triangles = triangles_of(mesh);
    ASSERT_EQ(points.size(), vertices.size());
    ASSERT_EQ(faces.size(), triangles.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_EQ((MeshVertex{points[i].x(), points[i].y(), points[i].z()}), vertices[i]);
    for (std::size_t i = 0; i < faces.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(faces[i].at(k), static_cast<std::size_t>(triangles[i][k]));
  }
}

// Programs stumble over more than this (QGIS issue 53791).
TEST(Ply, HasAPlainHeader) {
  TestFolder folder;
  MeshWriteOptions options;
  options.title = "two\nlines";
  options.normals = true;
  write_ply(hills(2, 0, 0), {"", "ft", 0.3048}, folder / "mesh.ply", options);
  const std::string bytes = get_file(folder / "mesh.ply");
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment two lines\ncomment vertical_unit ft = 0.3048 m\nelement vertex 4\n"
      "property double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  EXPECT_EQ(bytes.size(), header.size() + 4 * 36 + 2 * 13);
  std::array<float, 3> normal{};
  std::memcpy(normal.data(), bytes.data() + header.size() + 24, 12);
  EXPECT_EQ(normal, vertex_normals(hills(2, 0, 0), 0.3048)[0]);
}

TEST(Ply, OfOtherProgramsIsRead) {
  TestFolder folder;
  const std::vector<MeshVertex> vertices = {{0, 0, 1.5}, {1, 0, 2}, {0, 1, -3}};
  // Text with words over several lines, an element of its own, colours, and a list per vertex.
  put_file(folder / "text.ply",
           "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty uchar "
           "red\r\n"
           "property float z\r\nproperty list uchar int more\r\nelement edge 1\r\nproperty int a\r\nproperty int b\r\n"
           "element face 1\r\nproperty uchar flags\r\nproperty list uchar uint vertex_index\r\nend_header\r\n"
           "0 0 255 1.5 2 7 8\r\n1 0 255\r\n+2 0\r\n0 1 255 -3e0 1 9\r\n0 1\r\n200 3 0 1 2");
  // The bytes of 1.5f, 1.f, 2.f and -3.f, largest first (IEEE 754).
  put_file(
      folder / "big.ply",
      std::string("ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float32 y\nproperty short z\n"
                  "element face 1\nproperty list int ushort vertex_indices\nend_header\n") +
          std::string("\0\0\0\0\0\0\0\0\0\2", 10) + std::string("\x3f\x80\0\0\0\0\0\0\0\2", 10) +
          std::string("\0\0\0\0\x3f\x80\0\0\xff\xfd", 10) + std::string("\0\0\0\3\0\0\0\1\0\2", 10));
  for (const char* name : {"text.ply", "big.ply"}) {
    const MeshFile file = read_ply(folder / name, {});
    auto expected = vertices;
    if (std::string(name) == "big.ply") expected[0].z = 2;
    EXPECT_EQ(vertices_of(file.mesh), expected) << name;
    EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 1, 2}})) << name;
  }
}

TEST(Ply, WithBadContentsIsRefusedWithTheReason) {
  TestFolder folder;
  const std::string path = folder / "bad.ply",
                    vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
                    faces = "element face 1\nproperty list uchar int vertex_indices\n", points = "0 0 0 1 0 0 0 1 0 ";
  const struct {
    std::string text, expected;
  } cases[] = {
      {"ply\nformat ascii 1.0\n" + vertices + faces + "end_header\n" + points + "4 0 1 2 0", "expected 3"},
      {"ply\nformat ascii 1.0\n" + vertices + faces + "end_header\n" + points + "3 0 1 3", "names vertex 4 of 3"},
      {"ply\nformat ascii 1.0\n" + vertices + faces + "end_header\n" + points + "3 0 1 -1", "face 0"},
      {"ply\nformat ascii 1.0\n" + vertices + faces + "end_header\n" + points + "3 0 1 1.5", "face 0"},
      {"ply\nformat ascii 1.0\n" + vertices + faces + "end_header\n" + points, "where a number was expected"},
      {"ply\nformat ascii 1.0\n" + vertices + faces + "end_header\n0 0 nan 0 0 0 0 0 0 3 0 1 2", "'nan'"},
      {"ply\nformat ascii 1.0\nelement vertex 1152921504606846976\nproperty uchar x\nproperty uchar y\nproperty uchar "
       "z\nend_header\n0 0 0",
       "1152921504606846976"},
      {"ply\nformat binary_little_endian 1.0\nelement vertex 1152921504606846976\nproperty double x\nproperty double y\nproperty "
       "double z\nend_header\n",
       "1152921504606846976"},
      {"ply\nformat binary_little_endian 1.0\nelement nothing 9223372036854775807\n" + vertices + "end_header\n",
       "elements 'vertex'"},
      {"ply\nformat ascii 2.0\nelement vertex 1\nproperty long x\n", "'long'"},
      {"ply\nformat middle_endian 1.0\n", "'middle_endian'"},
      {"ply\nproperty float x\n", "before the first element"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0", "no x, y and z"},
      {"ply\nformat ascii 1.0\nelement vertex", "<count>"},
      {"ply\nformat ascii 1.0\n", "no end_header"},
  };
  for (const auto& bad : cases) {
    put_file(path, bad.text);
    const Error error = error_of([&] { read_ply(path, {}); });
    EXPECT_EQ(error.kind(), ErrorKind::input) << bad.text;
    EXPECT_NE(std::string(error.what()).find(bad.expected), std::string::npos) << error.what();
  }
}

/// More vertices than can be numbered; none may be read.
struct Endless final : MeshSource {
  std::int64_t vertices() const override { return (std::int64_t{1} << 32) + 1; }
  std::int64_t triangles() const override { return std::int64_t{1} << 33; }
  void read_vertices(std::int64_t, std::span<MeshVertex>) const override { FAIL(); }
  void read_triangles(std::int64_t, std::span<MeshTriangle>) const override { FAIL(); }
};

TEST(Ply, SaysItsLimit) {
  TestFolder folder;
  EXPECT_EQ(error_of([&] { write_ply(Endless(), {}, folder / "mesh.ply", {}); }).kind(), ErrorKind::format);
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace arete
