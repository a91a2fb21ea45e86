#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/file.h"
#include "gis/mesh/mesh_store.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {

/// Hills on a grid of `columns` x `rows` vertices from (x, y), with noise in all coordinates that no float32 holds.
inline MeshStore hill_mesh(int columns, int rows, double x, double y, double spacing, double relief = 800) {
  std::uint64_t state = 1;
  const auto noise = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 11) / 9007199254740992.0;
  };
  MeshStore mesh;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      mesh.append_vertices(std::vector<MeshVertex>{
          {x + (c + 0.4 * noise()) * spacing, y + (r + 0.4 * noise()) * spacing, 300 + relief * noise()}});
  const std::int64_t n = columns;
  for (std::int64_t r = 0; r + 1 < rows; ++r)
    for (std::int64_t c = 0; c + 1 < n; ++c) {
      const std::int64_t i = r * n + c;
      mesh.append_triangles(std::vector<MeshTriangle>{{i, i + 1, i + n}, {i + 1, i + n + 1, i + n}});
    }
  return mesh;
}

/// The corners of all triangles, nine numbers each, in an order that depends on nothing but them: each begins with its least corner.
using Corners = std::array<double, 9>;
inline std::vector<Corners> sorted(std::vector<Corners> all) {
  for (Corners& c : all) {
    Corners best = c;
    for (int turn = 0; turn < 2; ++turn) {
      std::rotate(c.begin(), c.begin() + 3, c.end());
      best = std::min(best, c);
    }
    c = best;
  }
  std::sort(all.begin(), all.end());
  return all;
}
inline std::vector<Corners> sorted_corners(const MeshSource& mesh, const std::function<MeshVertex(const MeshVertex&)>& move = [](const MeshVertex& v) { return v; }) {
  const std::vector<MeshVertex> vertices = vertices_of(mesh);
  std::vector<Corners> all;
  for (const MeshTriangle& t : triangles_of(mesh)) {
    Corners c;
    for (std::size_t i = 0; i < 3; ++i) {
      const MeshVertex v = move(vertices.at(static_cast<std::size_t>(t[i])));
      c[3 * i] = v.x, c[3 * i + 1] = v.y, c[3 * i + 2] = v.z;
    }
    all.push_back(c);
  }
  return sorted(std::move(all));
}

/// Reads every beginning of a file, and the file with single bytes changed, every `step`-th of them: each gives a mesh whose triangles
/// name its vertices, or an Error. Returns how many were refused.
inline int read_damaged(const std::string& path, const std::string& copy, std::size_t step, const std::function<MeshStore(const std::string&)>& read) {
  const std::vector<std::byte> good = read_file(path);
  int refused = 0;
  const auto attempt = [&](const std::vector<std::byte>& bytes) {
    // Not flushed to the disk, which would take most of the time.
    std::ofstream(copy, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
    try {
      const MeshStore mesh = read(copy);
      for (const MeshTriangle& t : triangles_of(mesh))
        for (const std::int64_t index : t) ASSERT_TRUE(index >= 0 && index < mesh.vertices());
    } catch (const Error&) {
      ++refused;
    }
  };
  for (std::size_t i = 0; i < good.size(); i += step) attempt({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i)});
  for (std::size_t i = 0; i < good.size(); i += step)
    for (const unsigned char change : {0x01, 0x80, 0xff}) {
      std::vector<std::byte> bad = good;
      bad[i] ^= std::byte{change};
      attempt(bad);
    }
  return refused;
}

}  // namespace arete
