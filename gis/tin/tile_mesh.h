#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace arete {

/// The triangles of a tile with their neighbours, in flat arrays: triangle t has the half-edges 3t, 3t + 1, 3t + 2; half-edge h runs
/// from vertex origin[h] to the origin of the next one of its triangle. Triangles turn so that orientation() is positive.
///
/// Places are whole numbers, `units` of them to a cell, counted from the centre of the tile's first cell: x with the columns, y with
/// the rows. Predicates on them are exact.
struct TileMesh {
  int units = 2;
  std::vector<std::int32_t> x, y;
  std::vector<double> z;                ///< metres
  std::vector<std::uint8_t> held;       ///< 1: keeps its place and elevation when the mesh is simplified
  std::vector<std::int32_t> leaving;    ///< a half-edge that leaves the vertex, on a border the one without a twin; -1: removed. Empty while vertices are inserted
  std::vector<std::int32_t> origin;     ///< per half-edge; -1: its triangle was removed
  std::vector<std::int32_t> twin;       ///< per half-edge, the same edge seen from the other side; -1 on a border
  std::vector<std::uint8_t> fixed;      ///< per half-edge: 1 where the edge must stay (a breakline)

  std::int32_t vertices() const { return static_cast<std::int32_t>(x.size()); }
  std::int32_t triangles() const { return static_cast<std::int32_t>(origin.size() / 3); }
  bool removed(std::int32_t triangle) const { return origin[static_cast<std::size_t>(3 * triangle)] < 0; }
  std::array<std::int32_t, 3> corners(std::int32_t triangle) const {
    const std::size_t h = static_cast<std::size_t>(3 * triangle);
    return {origin[h], origin[h + 1], origin[h + 2]};
  }
};

inline std::int32_t next_edge(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
inline std::int32_t previous_edge(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// Twice the area of the triangle in square units: positive where a, b, c turn as the triangles of a tile do.
inline std::int64_t orientation(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c) {
  const std::int64_t bx = mesh.x[b] - mesh.x[a], by = mesh.y[b] - mesh.y[a], cx = mesh.x[c] - mesh.x[a], cy = mesh.y[c] - mesh.y[a];
  return bx * cy - by * cx;
}

/// Whether p lies inside the circle through a, b and c. Not on it: ties keep the edge that is there.
bool in_circle(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t p);

std::int32_t add_vertex(TileMesh& mesh, std::int32_t x, std::int32_t y, double z, bool held);

/// Takes back the vertex that was added last, which no triangle has.
void drop_last_vertex(TileMesh& mesh);

/// The triangle in or on which the vertex, which belongs to none, lies; -1: none. Walks from the triangle `near`; looks at all where that leaves the mesh.
std::int32_t find_triangle(const TileMesh& mesh, std::int32_t near, std::int32_t vertex);

/// Makes three triangles of the one in whose inside the vertex lies. Leaves `leaving` as it is: link_vertices() sets it.
void split_triangle(TileMesh& mesh, std::int32_t triangle, std::int32_t vertex);

/// Splits the triangle, or the edge of it on which the vertex lies, then flips edges until the triangulation is constrained Delaunay
/// again. The vertex lies in the closed triangle and on none of its corners; it is held where it splits a fixed edge. Appends each triangle that is new or changed to
/// `changed`; one may stand there twice.
void insert_vertex(TileMesh& mesh, std::int32_t triangle, std::int32_t vertex, std::vector<std::int32_t>& changed);

/// Replaces the edge by the other diagonal of its two triangles, which must be convex. Keeps `leaving` where it is set.
void flip_edge(TileMesh& mesh, std::int32_t edge);

/// The neighbours of a vertex in their order about it, and for each the half-edge that leads to it; the last of a border has none (-1).
struct Ring {
  std::vector<std::int32_t> vertices, edges;
  bool closed = false;  ///< the vertex is no border vertex
  /// Triangles (vertex, vertices[i], vertices[i + 1]), cyclic where closed.
  std::size_t triangles() const { return closed ? vertices.size() : vertices.size() - 1; }
  std::int32_t after(std::size_t i) const { return vertices[i + 1 == vertices.size() ? 0 : i + 1]; }
};
void collect_ring(const TileMesh& mesh, std::int32_t vertex, Ring& ring);

/// Appends the triangles about the vertex that a half-edge leaves.
void append_star(const TileMesh& mesh, std::int32_t edge, std::vector<std::int32_t>& triangles);

/// Sets `leaving` of all vertices from the triangles.
void link_vertices(TileMesh& mesh);

/// Moves `from`, whose closed ring is given, onto its neighbour `to`, which keeps its place: the two triangles between them go. The
/// other triangles of the ring must keep their orientation.
void collapse_edge(TileMesh& mesh, std::int32_t from, const Ring& ring, std::int32_t to);

/// The same mesh without what was removed, vertices along a Z-order curve of their places, triangles in the order of their first
/// vertex, each beginning with it: what lies close together is close in memory, and the order depends on the mesh alone.
TileMesh sort_mesh(const TileMesh& mesh);

}  // namespace arete
