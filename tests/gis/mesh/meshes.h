#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/mesh/mesh_format.h"

namespace arete {

/// Hills over a grid of side x side vertices that is not aligned to any binary fraction: x0 + 10.1 i, y0 + 9.7 j. The diagonals
/// alternate. `height` is added to the hills.
inline MeshStore hills(int side, double x0, double y0, double height = 0, double spacing = 10.1) {
  MeshStore mesh;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      mesh.append_vertices(std::vector<MeshVertex>{
          {x0 + spacing * i, y0 + spacing * 0.96 * j, height + 100.3 * std::sin(0.7 * i) * std::cos(0.4 * j) - 0.1 * i}});
  const std::int64_t n = side;
  for (std::int64_t j = 0; j + 1 < n; ++j)
    for (std::int64_t i = 0; i + 1 < n; ++i) {
      const std::int64_t a = j * n + i;
      if ((i + j) % 2 == 0)
        mesh.append_triangles(std::vector<MeshTriangle>{{a, a + 1, a + n + 1}, {a, a + n + 1, a + n}});
      else
        mesh.append_triangles(std::vector<MeshTriangle>{{a, a + 1, a + n}, {a + 1, a + n + 1, a + n}});
    }
  return mesh;
}

inline MeshFrame frame_of(const std::string& crs) { return {crs_wkt(crs), "m", 1}; }

inline std::vector<MeshVertex> vertices_of(const MeshSource& mesh) {
  std::vector<MeshVertex> vertices(static_cast<std::size_t>(mesh.vertices()));
  mesh.read_vertices(0, vertices);
  return vertices;
}

inline std::vector<MeshTriangle> triangles_of(const MeshSource& mesh) {
  std::vector<MeshTriangle> triangles(static_cast<std::size_t>(mesh.triangles()));
  mesh.read_triangles(0, triangles);
  return triangles;
}

/// The corners of all triangles in order: what a mesh is, however its vertices are numbered.
inline std::vector<MeshVertex> corners_of(const MeshSource& mesh) {
  const std::vector<MeshVertex> vertices = vertices_of(mesh);
  std::vector<MeshVertex> corners;
  for (const MeshTriangle& triangle : triangles_of(mesh))
    for (const std::int64_t corner : triangle) corners.push_back(vertices.at(static_cast<std::size_t>(corner)));
  return corners;
}

/// Every index names a vertex, every coordinate is finite.
inline bool is_sound(const MeshSource& mesh) {
  for (const MeshTriangle& triangle : triangles_of(mesh))
    for (const std::int64_t corner : triangle)
      if (corner < 0 || corner >= mesh.vertices()) return false;
  for (const MeshVertex& v : vertices_of(mesh))
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  return true;
}

inline void put_file(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

inline std::string get_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The error of an action that must fail: its kind, and its message for a look.
inline Error error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return {ErrorKind::usage, ""};
}

/// A mesh as tests/gis/mesh/read_mesh.py reads it, written from the specifications of the formats alone.
inline MeshStore read_by_python(const std::string& path) {
  const std::string command =
      std::string(ARETE_TEST_PYTHON) + " -B " ARETE_SOURCE_DIR "/tests/gis/mesh/read_mesh.py '" + path + "'";
  std::FILE* output = ::popen(command.c_str(), "r");
  MeshStore mesh;
  char kind = 0;
  while (std::fscanf(output, " %c", &kind) == 1) {
    MeshVertex v;
    long long a = 0, b = 0, c = 0;
    if (kind == 'v' && std::fscanf(output, "%la %la %la", &v.x, &v.y, &v.z) == 3)
      mesh.append_vertices(std::vector<MeshVertex>{v});
    else if (kind == 'f' && std::fscanf(output, "%lld %lld %lld", &a, &b, &c) == 3)
      mesh.append_triangles(std::vector<MeshTriangle>{{a, b, c}});
  }
  EXPECT_EQ(::pclose(output), 0) << command;
  return mesh;
}

}  // namespace arete
