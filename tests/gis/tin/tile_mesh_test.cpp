#include "gis/tin/tile_mesh.h"

#include <set>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

/// A square of so many cells, cut along a diagonal.
TileMesh square(std::int32_t cells) {
  TileMesh mesh;
  const std::int32_t side = cells * mesh.units;
  for (const auto& [x, y] : {std::pair{0, 0}, {side, 0}, {side, side}, {0, side}}) add_vertex(mesh, x, y, 0, true);
  mesh.origin = {0, 1, 2, 0, 2, 3};
  mesh.twin = {-1, -1, 3, 2, -1, -1};
  mesh.fixed.assign(6, 0);
  return mesh;
}

/// Twins name each other and run the other way; triangles turn the right way; their areas add up.
void expect_sound(const TileMesh& mesh, std::int64_t twice_area) {
  std::int64_t area = 0;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    if (mesh.removed(t)) continue;
    const auto [a, b, c] = mesh.corners(t);
    EXPECT_GT(orientation(mesh, a, b, c), 0);
    area += orientation(mesh, a, b, c);
    for (std::int32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::int32_t twin = mesh.twin[h];
      if (!mesh.leaving.empty()) {
        EXPECT_EQ(mesh.origin[mesh.leaving[mesh.origin[h]]], mesh.origin[h]);
      }
      if (twin < 0) continue;
      ASSERT_EQ(mesh.twin[twin], h);
      EXPECT_EQ(mesh.origin[twin], mesh.origin[next_edge(h)]);
      EXPECT_EQ(mesh.origin[next_edge(twin)], mesh.origin[h]);
      EXPECT_EQ(mesh.fixed[twin], mesh.fixed[h]);
    }
  }
  EXPECT_EQ(area, twice_area);
}

bool is_delaunay(const TileMesh& mesh) {
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t twin = mesh.twin[h];
    if (mesh.origin[h] < 0 || twin < 0 || mesh.fixed[h]) continue;
    if (in_circle(mesh, mesh.origin[h], mesh.origin[next_edge(h)], mesh.origin[previous_edge(h)], mesh.origin[previous_edge(twin)])) return false;
  }
  return true;
}

std::int32_t triangle_at(const TileMesh& mesh, std::int32_t v) {
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    if (orientation(mesh, a, b, v) >= 0 && orientation(mesh, b, c, v) >= 0 && orientation(mesh, c, a, v) >= 0) return t;
  }
  return -1;
}

TileMesh scattered(std::uint64_t seed, std::int32_t cells, int vertices) {
  TileMesh mesh = square(cells);
  std::set<std::pair<std::int32_t, std::int32_t>> taken{{0, 0}, {0, cells}, {cells, 0}, {cells, cells}};
  std::vector<std::int32_t> changed;
  for (int i = 0; i < vertices; ++i) {
    const auto x = static_cast<std::int32_t>(uniform_at(seed, 2 * static_cast<std::uint64_t>(i)) * (cells + 1));
    const auto y = static_cast<std::int32_t>(uniform_at(seed, 2 * static_cast<std::uint64_t>(i) + 1) * (cells + 1));
    if (!taken.insert({x, y}).second) continue;
    const std::int32_t v = add_vertex(mesh, x * mesh.units, y * mesh.units, 0, false);
    insert_vertex(mesh, triangle_at(mesh, v), v, changed);
  }
  return mesh;
}

TEST(InsertVertex, StaysDelaunayInsideOnEdgesAndOnTheBorder) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TileMesh mesh = scattered(seed, 12, 80);  // dense: many lie on edges and on circles
    expect_sound(mesh, 2 * 24 * 24);
    EXPECT_TRUE(is_delaunay(mesh));
    // Euler: triangles = 2 vertices - 2 - border vertices.
    std::int32_t border = 0;
    for (const std::int32_t twin : mesh.twin) border += twin < 0;
    EXPECT_EQ(mesh.triangles(), 2 * mesh.vertices() - 2 - border);
  }
}

TEST(FindTriangle, WalksAcrossTheMeshAndAroundItsGaps) {
  TileMesh mesh = square(40);
  std::vector<std::int32_t> changed;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto at = [&](std::uint64_t k) { return 1 + static_cast<std::int32_t>(uniform_at(k, i) * 78); };
    const std::int32_t v = add_vertex(mesh, at(1), at(2), 0, false), triangle = find_triangle(mesh, 0, v);
    ASSERT_GE(triangle, 0);
    const auto [a, b, c] = mesh.corners(triangle);
    EXPECT_TRUE(orientation(mesh, a, b, v) >= 0 && orientation(mesh, b, c, v) >= 0 && orientation(mesh, c, a, v) >= 0);
    const auto same_place = [&](std::int32_t u) { return mesh.x[u] == mesh.x[v] && mesh.y[u] == mesh.y[v]; };
    if (same_place(a) || same_place(b) || same_place(c)) drop_last_vertex(mesh);
    else insert_vertex(mesh, triangle, v, changed);
  }
  const std::int32_t outside = add_vertex(mesh, 100, 30, 0, false);
  EXPECT_EQ(find_triangle(mesh, 0, outside), -1);
  // Two triangles that do not touch: the walk ends at a border.
  TileMesh parts;
  for (const auto& [x, y] : {std::pair{0, 0}, {4, 0}, {0, 4}, {20, 0}, {24, 0}, {20, 4}}) add_vertex(parts, x, y, 0, false);
  parts.origin = {0, 1, 2, 3, 4, 5};
  parts.twin = {-1, -1, -1, -1, -1, -1};
  EXPECT_EQ(find_triangle(parts, 0, add_vertex(parts, 21, 1, 0, false)), 1);
}

TEST(InsertVertex, LeavesFixedEdges) {
  TileMesh mesh = square(10);
  mesh.fixed = {0, 0, 1, 1, 0, 0};
  std::vector<std::int32_t> changed;
  for (const auto& [x, y] : {std::pair{18, 16}, {16, 18}, {4, 4}, {10, 12}}) {
    const std::int32_t v = add_vertex(mesh, x, y, 0, false);
    insert_vertex(mesh, triangle_at(mesh, v), v, changed);
  }
  expect_sound(mesh, 2 * 20 * 20);
  EXPECT_EQ(mesh.held[6], 1);  // (4, 4) split the diagonal
  EXPECT_EQ(mesh.held[4], 0);
  std::int32_t along = 0;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t a = mesh.origin[h], b = mesh.origin[next_edge(h)];
    if (mesh.fixed[h] && mesh.x[a] == mesh.y[a] && mesh.x[b] == mesh.y[b] && mesh.x[b] > mesh.x[a]) along += mesh.x[b] - mesh.x[a];
  }
  EXPECT_EQ(along, 20);
}

TEST(InCircle, IsExactForFineUnits) {
  TileMesh mesh;
  mesh.units = 1 << 16;
  const std::int32_t r = 1000 << 16;
  for (const auto& [x, y] : {std::pair{0, 0}, {r, 0}, {r, r}, {0, r}, {0, r - 1}, {-1, r}}) add_vertex(mesh, x, y, 0, false);
  EXPECT_FALSE(in_circle(mesh, 0, 1, 2, 3));
  EXPECT_TRUE(in_circle(mesh, 0, 1, 2, 4));
  EXPECT_FALSE(in_circle(mesh, 0, 1, 2, 5));
}

TEST(CollapseEdge, KeepsAHalfEdgeMesh) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    TileMesh mesh = sort_mesh([&] {
      TileMesh made = scattered(seed, 30, 60);
      link_vertices(made);
      return made;
    }());
    Ring ring;
    int collapsed = 0;
    for (std::int32_t v = 0; v < mesh.vertices(); ++v) {
      if (mesh.held[v]) continue;
      collect_ring(mesh, v, ring);
      if (!ring.closed) continue;
      for (const std::int32_t to : ring.vertices) {
        bool turns = true;
        for (std::size_t i = 0; i < ring.triangles(); ++i)
          if (ring.vertices[i] != to && ring.after(i) != to) turns = turns && orientation(mesh, to, ring.vertices[i], ring.after(i)) > 0;
        Ring other;
        collect_ring(mesh, to, other);
        int common = 0;
        for (const std::int32_t n : other.vertices) common += std::find(ring.vertices.begin(), ring.vertices.end(), n) != ring.vertices.end();
        if (!turns || common != 2) continue;
        collapse_edge(mesh, v, ring, to);
        ++collapsed;
        break;
      }
    }
    EXPECT_GT(collapsed, 20);
    expect_sound(mesh, 2 * 60 * 60);
    expect_sound(sort_mesh(mesh), 2 * 60 * 60);
  }
}

TEST(FlipEdge, TurnsTheDiagonal) {
  TileMesh mesh = square(4);
  link_vertices(mesh);
  flip_edge(mesh, 2);
  expect_sound(mesh, 2 * 8 * 8);
  Ring ring;
  collect_ring(mesh, 1, ring);
  EXPECT_EQ(ring.vertices.size(), 3u);
}

TEST(SortMesh, DependsOnTheMeshAlone) {
  TileMesh mesh = scattered(3, 20, 50);
  link_vertices(mesh);
  const TileMesh once = sort_mesh(mesh), twice = sort_mesh(once);
  EXPECT_EQ(once.x, twice.x);
  EXPECT_EQ(once.origin, twice.origin);
  EXPECT_EQ(once.twin, twice.twin);
}

}  // namespace
}  // namespace arete
