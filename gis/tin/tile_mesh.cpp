#include "gis/tin/tile_mesh.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace arete {
namespace {

void join(TileMesh& mesh, std::int32_t h, std::int32_t twin) {
  mesh.twin[h] = twin;
  if (twin >= 0) mesh.twin[twin] = h;
}

/// An edge of a triangle towards the outside: its twin, and whether it is fixed.
struct Outer {
  std::int32_t twin = -1;
  std::uint8_t fixed = 0;
};

Outer outer(const TileMesh& mesh, std::int32_t h) { return {mesh.twin[h], mesh.fixed[h]}; }

/// Makes a triangle in the place of another or, where `triangle` is -1, at the end. Returns its index.
std::int32_t put_triangle(TileMesh& mesh, std::int32_t triangle, std::array<std::int32_t, 3> corners, std::array<Outer, 3> edges) {
  if (triangle < 0) {
    triangle = mesh.triangles();
    mesh.origin.resize(mesh.origin.size() + 3);
    mesh.twin.resize(mesh.origin.size());
    mesh.fixed.resize(mesh.origin.size());
  }
  for (std::int32_t k = 0; k < 3; ++k) {
    const std::int32_t h = 3 * triangle + k;
    mesh.origin[h] = corners[static_cast<std::size_t>(k)];
    mesh.fixed[h] = edges[static_cast<std::size_t>(k)].fixed;
    join(mesh, h, edges[static_cast<std::size_t>(k)].twin);
  }
  return triangle;
}

/// Flips edges opposite to the new vertex until none has the vertex beyond it inside its circle. Each half-edge of the stack is
/// opposite to the new vertex.
void legalise(TileMesh& mesh, std::vector<std::int32_t>& stack, std::vector<std::int32_t>& changed) {
  while (!stack.empty()) {
    const std::int32_t edge = stack.back();
    stack.pop_back();
    const std::int32_t twin = mesh.twin[edge];
    if (twin < 0 || mesh.fixed[edge]) continue;
    const std::int32_t apex = mesh.origin[previous_edge(edge)], beyond = mesh.origin[previous_edge(twin)];
    if (!in_circle(mesh, apex, mesh.origin[edge], mesh.origin[next_edge(edge)], beyond)) continue;
    flip_edge(mesh, edge);
    // The two triangles are now (apex, beyond, left) and (beyond, apex, right): the outer edges at `beyond` are opposite to the apex.
    changed.push_back(edge / 3);
    changed.push_back(twin / 3);
    stack.push_back(3 * (edge / 3) + 1);
    stack.push_back(3 * (twin / 3) + 2);
  }
}

void split_edge(TileMesh& mesh, std::int32_t edge, std::int32_t vertex, std::vector<std::int32_t>& stack, std::vector<std::int32_t>& changed) {
  const std::int32_t twin = mesh.twin[edge];
  const std::uint8_t fixed = mesh.fixed[edge];
  if (fixed) mesh.held[vertex] = 1;
  const std::int32_t apex = mesh.origin[previous_edge(edge)], right = mesh.origin[edge], left = mesh.origin[next_edge(edge)];
  const Outer to_left = outer(mesh, next_edge(edge)), to_right = outer(mesh, previous_edge(edge));
  const auto push = [&](std::initializer_list<std::int32_t> made) {
    for (const std::int32_t t : made) {
      stack.push_back(3 * t);
      changed.push_back(t);
    }
  };
  if (twin < 0) {
    const std::int32_t first = put_triangle(mesh, edge / 3, {apex, right, vertex}, {to_right, {-1, fixed}, {}});
    const std::int32_t second = put_triangle(mesh, -1, {left, apex, vertex}, {to_left, {3 * first + 2, 0}, {-1, fixed}});
    push({first, second});
  } else {
    const std::int32_t beyond = mesh.origin[previous_edge(twin)];
    const Outer from_right = outer(mesh, next_edge(twin)), from_left = outer(mesh, previous_edge(twin));
    const std::int32_t first = put_triangle(mesh, edge / 3, {apex, right, vertex}, {to_right, {-1, fixed}, {}});
    const std::int32_t second = put_triangle(mesh, twin / 3, {right, beyond, vertex}, {from_right, {}, {3 * first + 1, fixed}});
    const std::int32_t third = put_triangle(mesh, -1, {beyond, left, vertex}, {from_left, {-1, fixed}, {3 * second + 1, 0}});
    const std::int32_t fourth = put_triangle(mesh, -1, {left, apex, vertex}, {to_left, {3 * first + 2, 0}, {3 * third + 1, fixed}});
    push({first, second, third, fourth});
  }
}

/// Turns `leaving` of a vertex clockwise to the border, where it has one.
void find_border(TileMesh& mesh, std::int32_t vertex) {
  const std::int32_t start = mesh.leaving[vertex];
  for (std::int32_t h = start;;) {
    const std::int32_t twin = mesh.twin[h];
    if (twin < 0) {
      mesh.leaving[vertex] = h;
      return;
    }
    h = next_edge(twin);
    if (h == start) return;
  }
}

/// Makes `leaving` of a vertex one of these two half-edges, or what follows it: whichever leaves the vertex.
void relink(TileMesh& mesh, std::int32_t vertex, std::int32_t first, std::int32_t second) {
  for (const std::int32_t h : {first, second}) {
    if (h < 0) continue;
    mesh.leaving[vertex] = mesh.origin[h] == vertex ? h : next_edge(h);
    return;
  }
}

/// Bits of two numbers in turn: neighbours in the plane are mostly neighbours in it.
std::uint64_t z_order(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint64_t v) {
    v = (v | v << 16) & 0x0000ffff0000ffffu;
    v = (v | v << 8) & 0x00ff00ff00ff00ffu;
    v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fu;
    v = (v | v << 2) & 0x3333333333333333u;
    return (v | v << 1) & 0x5555555555555555u;
  };
  return spread(x) | spread(y) << 1;
}

template <class T>
T in_circle_determinant(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t p) {
  const T ax = mesh.x[a] - mesh.x[p], ay = mesh.y[a] - mesh.y[p], bx = mesh.x[b] - mesh.x[p], by = mesh.y[b] - mesh.y[p],
          cx = mesh.x[c] - mesh.x[p], cy = mesh.y[c] - mesh.y[p];
  const T aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  return ax * (by * cc - bb * cy) - ay * (bx * cc - bb * cx) + aa * (bx * cy - by * cx);
}

}  // namespace

bool in_circle(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t p) {
  // A tile is at most 2^12 cells wide: in half cells the determinant stays below 2^56.
  if (mesh.units == 2) return in_circle_determinant<std::int64_t>(mesh, a, b, c, p) > 0;
  __extension__ using Wide = __int128;
  return in_circle_determinant<Wide>(mesh, a, b, c, p) > 0;
}

std::int32_t add_vertex(TileMesh& mesh, std::int32_t x, std::int32_t y, double z, bool held) {
  mesh.x.push_back(x);
  mesh.y.push_back(y);
  mesh.z.push_back(z);
  mesh.held.push_back(held);
  return mesh.vertices() - 1;
}

void drop_last_vertex(TileMesh& mesh) {
  mesh.x.pop_back();
  mesh.y.pop_back();
  mesh.z.pop_back();
  mesh.held.pop_back();
}

std::int32_t find_triangle(const TileMesh& mesh, std::int32_t near, std::int32_t vertex) {
  constexpr int most_steps = 1000;
  std::int32_t h = 3 * near;
  for (int seen = 0, step = 0; h >= 0 && step < most_steps; ++step) {
    if (orientation(mesh, mesh.origin[h], mesh.origin[next_edge(h)], vertex) < 0) {
      h = mesh.twin[h];
      seen = 0;
    } else if (++seen == 3) {
      return h / 3;
    } else {
      h = next_edge(h);
    }
  }
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    if (orientation(mesh, a, b, vertex) >= 0 && orientation(mesh, b, c, vertex) >= 0 && orientation(mesh, c, a, vertex) >= 0) return t;
  }
  return -1;
}

void split_triangle(TileMesh& mesh, std::int32_t triangle, std::int32_t vertex) {
  const std::int32_t h = 3 * triangle;
  const auto [a, b, c] = mesh.corners(triangle);
  const Outer ab = outer(mesh, h), bc = outer(mesh, h + 1), ca = outer(mesh, h + 2);
  const std::int32_t first = put_triangle(mesh, triangle, {a, b, vertex}, {ab, {}, {}});
  const std::int32_t second = put_triangle(mesh, -1, {b, c, vertex}, {bc, {}, {3 * first + 1, 0}});
  put_triangle(mesh, -1, {c, a, vertex}, {ca, {3 * first + 2, 0}, {3 * second + 1, 0}});
}

void insert_vertex(TileMesh& mesh, std::int32_t triangle, std::int32_t vertex, std::vector<std::int32_t>& changed) {
  thread_local std::vector<std::int32_t> stack;
  stack.clear();
  for (std::int32_t h = 3 * triangle; h < 3 * triangle + 3; ++h)
    if (orientation(mesh, mesh.origin[h], mesh.origin[next_edge(h)], vertex) == 0) {
      split_edge(mesh, h, vertex, stack, changed);
      return legalise(mesh, stack, changed);
    }
  const std::int32_t next = mesh.triangles();
  split_triangle(mesh, triangle, vertex);
  for (const std::int32_t t : {triangle, next, next + 1}) {
    stack.push_back(3 * t);
    changed.push_back(t);
  }
  legalise(mesh, stack, changed);
}

void flip_edge(TileMesh& mesh, std::int32_t edge) {
  const std::int32_t twin = mesh.twin[edge];
  const std::int32_t apex = mesh.origin[previous_edge(edge)], beyond = mesh.origin[previous_edge(twin)];
  const std::int32_t right = mesh.origin[edge], left = mesh.origin[next_edge(edge)];
  const Outer to_left = outer(mesh, next_edge(edge)), to_right = outer(mesh, previous_edge(edge));
  const Outer from_right = outer(mesh, next_edge(twin)), from_left = outer(mesh, previous_edge(twin));
  const std::int32_t first = edge / 3, second = twin / 3;
  put_triangle(mesh, first, {apex, beyond, left}, {Outer{}, from_left, to_left});
  put_triangle(mesh, second, {beyond, apex, right}, {Outer{3 * first, 0}, to_right, from_right});
  if (mesh.leaving.empty()) return;
  mesh.leaving[apex] = 3 * first;
  mesh.leaving[beyond] = 3 * second;
  mesh.leaving[left] = 3 * first + 2;
  mesh.leaving[right] = 3 * second + 2;
  for (const std::int32_t v : {apex, beyond, left, right}) find_border(mesh, v);
}

void collect_ring(const TileMesh& mesh, std::int32_t vertex, Ring& ring) {
  ring.vertices.clear();
  ring.edges.clear();
  const std::int32_t start = mesh.leaving[vertex];
  std::int32_t h = start;
  do {
    ring.vertices.push_back(mesh.origin[next_edge(h)]);
    ring.edges.push_back(h);
    const std::int32_t arriving = previous_edge(h);
    h = mesh.twin[arriving];
    if (h < 0) {
      ring.vertices.push_back(mesh.origin[arriving]);
      ring.edges.push_back(-1);
      ring.closed = false;
      return;
    }
  } while (h != start);
  ring.closed = true;
}

void append_star(const TileMesh& mesh, std::int32_t edge, std::vector<std::int32_t>& triangles) {
  std::int32_t h = edge;
  do {
    triangles.push_back(h / 3);
    h = mesh.twin[previous_edge(h)];
  } while (h >= 0 && h != edge);
  if (h >= 0) return;
  for (h = mesh.twin[edge]; h >= 0; h = mesh.twin[next_edge(h)]) triangles.push_back(h / 3);
}

void link_vertices(TileMesh& mesh) {
  mesh.leaving.assign(mesh.x.size(), -1);
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t v = mesh.origin[h];
    if (v >= 0 && (mesh.leaving[v] < 0 || mesh.twin[h] < 0)) mesh.leaving[v] = h;
  }
}

void collapse_edge(TileMesh& mesh, std::int32_t from, const Ring& ring, std::int32_t to) {
  for (const std::int32_t h : ring.edges) mesh.origin[h] = to;
  for (std::size_t i = 0; i < ring.triangles(); ++i) {
    const std::int32_t a = ring.vertices[i], b = ring.after(i);
    if (a != to && b != to) continue;
    // The triangle (from, a, b) goes; the two triangles beyond its other edges become neighbours.
    const std::int32_t h = ring.edges[i];
    const std::int32_t side = a == to ? next_edge(h) : h, other = a == to ? previous_edge(h) : next_edge(h);
    const std::int32_t first = mesh.twin[side], second = mesh.twin[other];
    const std::uint8_t fixed = mesh.fixed[side] | mesh.fixed[other];
    if (first >= 0) mesh.twin[first] = second, mesh.fixed[first] = fixed;
    if (second >= 0) mesh.twin[second] = first, mesh.fixed[second] = fixed;
    for (std::int32_t k = h - h % 3; k < h - h % 3 + 3; ++k) mesh.origin[k] = -1;
    relink(mesh, a == to ? b : a, first, second);
    relink(mesh, to, first, second);
  }
  mesh.leaving[from] = -1;
  for (const std::int32_t v : ring.vertices) find_border(mesh, v);
}

TileMesh sort_mesh(const TileMesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::int32_t>> order;
  order.reserve(mesh.x.size());
  for (std::int32_t v = 0; v < mesh.vertices(); ++v)
    if (mesh.leaving.empty() || mesh.leaving[v] >= 0)
      order.emplace_back(z_order(static_cast<std::uint32_t>(mesh.x[v]), static_cast<std::uint32_t>(mesh.y[v])), v);
  std::sort(order.begin(), order.end());

  TileMesh sorted;
  sorted.units = mesh.units;
  std::vector<std::int32_t> rank(mesh.x.size(), -1);
  for (const auto& [key, v] : order) rank[v] = add_vertex(sorted, mesh.x[v], mesh.y[v], mesh.z[v], mesh.held[v]);

  struct Turned {
    std::array<std::int32_t, 3> corners;
    std::int32_t half_edge;  // of the old mesh, that leaves the first corner
  };
  std::vector<Turned> triangles;
  triangles.reserve(mesh.origin.size() / 3);
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    if (mesh.removed(t)) continue;
    std::int32_t h = 3 * t;
    for (std::int32_t k = h + 1; k < 3 * t + 3; ++k)
      if (rank[mesh.origin[k]] < rank[mesh.origin[h]]) h = k;
    triangles.push_back({{rank[mesh.origin[h]], rank[mesh.origin[next_edge(h)]], rank[mesh.origin[previous_edge(h)]]}, h});
  }
  std::sort(triangles.begin(), triangles.end(), [](const Turned& a, const Turned& b) { return a.corners < b.corners; });

  std::vector<std::int32_t> place(mesh.origin.size(), -1);  // of a half-edge of the old mesh in the new one
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::int32_t h = triangles[t].half_edge;
    for (std::size_t k = 0; k < 3; ++k, h = next_edge(h)) place[h] = static_cast<std::int32_t>(3 * t + k);
  }
  sorted.origin.resize(3 * triangles.size());
  sorted.twin.resize(3 * triangles.size());
  sorted.fixed.resize(3 * triangles.size());
  for (std::size_t h = 0; h < place.size(); ++h) {
    if (place[h] < 0) continue;
    sorted.origin[place[h]] = rank[mesh.origin[h]];
    sorted.twin[place[h]] = mesh.twin[h] < 0 ? -1 : place[mesh.twin[h]];
    sorted.fixed[place[h]] = mesh.fixed[h];
  }
  link_vertices(sorted);
  return sorted;
}

}  // namespace arete
