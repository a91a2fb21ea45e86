#include "gis/tin/tile_domain.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/support/error.h"
#include "gis/tin/drape_lines.h"
#include "gis/tin/heights.h"

namespace arete {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                                                 CGAL::No_constraint_intersection_requiring_constructions_tag>;

/// Vertices by their place, and the segments between them that the triangulation must have.
struct Outline {
  TileMesh mesh;  ///< vertices only
  std::unordered_map<std::uint64_t, std::int32_t> index;
  std::vector<std::pair<std::int32_t, std::int32_t>> segments;
  std::vector<std::pair<std::int32_t, std::int32_t>> boundary;  ///< of the segments, those with the inside on one side alone; ascending ends

  std::int32_t find(std::int32_t x, std::int32_t y) const {
    const auto found = index.find(key(x, y));
    return found == index.end() ? -1 : found->second;
  }
  std::int32_t add(std::int32_t x, std::int32_t y, double z) {
    const auto [place, fresh] = index.try_emplace(key(x, y), mesh.vertices());
    if (fresh) add_vertex(mesh, x, y, z, true);
    return place->second;
  }
  static std::uint64_t key(std::int32_t x, std::int32_t y) { return std::uint64_t{static_cast<std::uint32_t>(x)} << 32 | static_cast<std::uint32_t>(y); }
};

bool is_valid(const TileCells& cells, std::int64_t column, std::int64_t row) {
  return column >= 0 && row >= 0 && column < cells.width && row < cells.height && !is_void(cells(column, row));
}

void add_border(Outline& outline, const TileCells& cells, const TileBorder& border) {
  const auto right = static_cast<std::int32_t>(cells.width - 1) * outline.mesh.units, bottom = static_cast<std::int32_t>(cells.height - 1) * outline.mesh.units;
  const auto add = [&](const std::vector<Polyline>& lines, const auto& place) {
    for (const Polyline& line : lines)
      for (std::size_t i = 0; i < line.size(); ++i) {
        const auto [x, y] = place(line[i].at);
        const std::int32_t v = outline.add(x, y, line[i].z);
        if (i == 0) continue;
        const auto [px, py] = place(line[i - 1].at);
        outline.segments.emplace_back(outline.find(px, py), v);
      }
  };
  using Place = std::pair<std::int32_t, std::int32_t>;
  add(border.top, [](std::int32_t at) { return Place{at, 0}; });
  add(border.bottom, [&](std::int32_t at) { return Place{at, bottom}; });
  add(border.left, [](std::int32_t at) { return Place{0, at}; });
  add(border.right, [&](std::int32_t at) { return Place{right, at}; });
}

/// The sides between valid and void cells, straight runs in as few segments as may be. `transposed`: those along rows instead of columns.
void add_voids(Outline& outline, const TileCells& cells, bool transposed, double step, double longest_cells) {
  const auto longest = static_cast<std::int64_t>(std::clamp(longest_cells, 1.0, any_length));
  const std::int64_t across = transposed ? cells.height : cells.width, along = transposed ? cells.width : cells.height;
  const std::int32_t units = outline.mesh.units, end = static_cast<std::int32_t>(along - 1) * units;
  const auto valid = [&](std::int64_t i, std::int64_t j) { return transposed ? is_valid(cells, j, i) : is_valid(cells, i, j); };
  for (std::int64_t i = 0; i + 1 < across; ++i) {
    const std::int32_t line = static_cast<std::int32_t>(i) * units + units / 2;
    const auto vertex = [&](std::int64_t j) {  // at the upper end of cell j
      const std::int32_t at = std::clamp(static_cast<std::int32_t>(j) * units - units / 2, 0, end);
      const std::int32_t x = transposed ? at : line, y = transposed ? line : at;
      const double z = transposed ? corner_height(cells, j - 1, i, step) : corner_height(cells, i, j - 1, step);
      return outline.add(x, y, z);
    };
    for (std::int64_t j = 0; j < along;) {
      const int side = valid(i, j) - valid(i + 1, j);
      if (side == 0) {
        ++j;
        continue;
      }
      const std::int64_t first = j;
      while (j < along && valid(i, j) - valid(i + 1, j) == side) ++j;
      const std::int64_t pieces = (j - first + longest - 1) / longest;
      for (std::int64_t k = 0; k < pieces; ++k)
        outline.segments.emplace_back(vertex(first + (j - first) * k / pieces), vertex(first + (j - first) * (k + 1) / pieces));
    }
  }
}

using Place = std::array<std::int32_t, 2>;

/// Where a piece crosses sides between valid and void cells. Crossings come as they are found.
std::vector<Place> void_crossings(const LinePiece& piece, const TileCells& cells, std::int32_t units) {
  std::vector<Place> crossings;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::int32_t low = std::min(piece.from[k], piece.to[k]), high = std::max(piece.from[k], piece.to[k]);
    const double slope = static_cast<double>(piece.to[1 - k] - piece.from[1 - k]) / (piece.to[k] - piece.from[k]);
    for (std::int32_t cell = (low + units / 2) / units; cell * units + units / 2 < high; ++cell) {
      const std::int32_t at = cell * units + units / 2;
      if (at <= low) continue;
      Place p;
      p[k] = at;
      p[1 - k] = static_cast<std::int32_t>(std::lround(piece.from[1 - k] + slope * (at - piece.from[k])));
      const std::int32_t other = (p[1 - k] + units / 2) / units;
      const bool before = k == 0 ? is_valid(cells, cell, other) : is_valid(cells, other, cell);
      const bool after = k == 0 ? is_valid(cells, cell + 1, other) : is_valid(cells, other, cell + 1);
      if (before != after && p != piece.from && p != piece.to) crossings.push_back(p);
    }
  }
  return crossings;
}

/// Whether a valid cell lies about the middle of a straight line.
bool is_over_valid(const Place& a, const Place& b, const TileCells& cells, std::int32_t units) {
  const std::int64_t x = std::int64_t{a[0]} + b[0] + units, y = std::int64_t{a[1]} + b[1] + units;
  for (const int dx : {-1, 1})
    for (const int dy : {-1, 1})
      if (is_valid(cells, (x + dx) / (2 * units), (y + dy) / (2 * units))) return true;
  return false;
}

void add_lines(Outline& outline, const TileCells& cells, const TileLines& lines, double step) {
  const std::int32_t units = outline.mesh.units;
  const auto height_at = [&](const Place& p) {
    const double height = height_between(cells, static_cast<double>(p[0]) / units, static_cast<double>(p[1]) / units);
    return std::isnan(height) ? 0 : height;  // amid voids: of no triangle
  };
  const auto vertex = [&](const Place& p) { return outline.add(p[0], p[1], round_height(height_at(p), step)); };
  for (const LinePiece& piece : lines.pieces) {
    std::vector<Place> chain = void_crossings(piece, cells, units);
    chain.push_back(piece.from);
    chain.push_back(piece.to);
    const auto along = [&](const Place& p) {
      return std::int64_t{piece.to[0] - piece.from[0]} * (p[0] - piece.from[0]) + std::int64_t{piece.to[1] - piece.from[1]} * (p[1] - piece.from[1]);
    };
    std::sort(chain.begin(), chain.end(), [&](const Place& a, const Place& b) { return std::pair(along(a), a) < std::pair(along(b), b); });
    for (std::size_t i = 1; i < chain.size(); ++i) {
      if (chain[i - 1] == chain[i] || (!piece.boundary && !is_over_valid(chain[i - 1], chain[i], cells, units))) continue;
      const std::int32_t from = vertex(chain[i - 1]), to = vertex(chain[i]);
      outline.segments.emplace_back(from, to);
      if (piece.boundary) outline.boundary.emplace_back(std::min(from, to), std::max(from, to));
    }
  }
  std::sort(outline.boundary.begin(), outline.boundary.end());
}

Triangulation triangulate(const Outline& outline) {
  std::vector<std::pair<Kernel::Point_2, std::int32_t>> points;
  for (std::int32_t v = 0; v < outline.mesh.vertices(); ++v) points.emplace_back(Kernel::Point_2(outline.mesh.x[v], outline.mesh.y[v]), v);
  Triangulation triangulation;
  triangulation.insert(points.begin(), points.end());
  std::vector<Triangulation::Vertex_handle> handles(points.size());
  for (const auto vertex : triangulation.finite_vertex_handles()) handles[vertex->info()] = vertex;
  try {
    for (const auto& [from, to] : outline.segments) triangulation.insert_constraint(handles[from], handles[to]);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    throw Error(ErrorKind::input, "lines cross closer to each other than 1/65536 of a cell: simplify them first");
  }
  return triangulation;
}

bool is_inside(const Outline& outline, const TileCells& cells, Triangulation::Face_handle face) {
  double x = 0, y = 0;
  for (int k = 0; k < 3; ++k) x += outline.mesh.x[face->vertex(k)->info()], y += outline.mesh.y[face->vertex(k)->info()];
  const double cell = 3.0 * outline.mesh.units;
  return is_valid(cells, static_cast<std::int64_t>(std::floor(x / cell + 0.5)), static_cast<std::int64_t>(std::floor(y / cell + 0.5)));
}

/// Which faces, by their info, lie inside the boundary: it is crossed at its edges, from one face of which it is asked.
std::vector<std::uint8_t> faces_inside(const Outline& outline, const Triangulation& triangulation, const DomainLines& lines) {
  std::vector<std::uint8_t> inside(triangulation.number_of_faces(), 2);  // 2: not known yet
  const auto corner = [&](Triangulation::Face_handle face, int k) { return face->vertex(k)->info(); };
  Triangulation::Face_handle widest;
  double most = -1;
  for (const auto face : triangulation.finite_face_handles()) {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, std::hypot(outline.mesh.x[corner(face, k)] - outline.mesh.x[corner(face, (k + 1) % 3)],
                                             outline.mesh.y[corner(face, k)] - outline.mesh.y[corner(face, (k + 1) % 3)]));
    const double height = static_cast<double>(orientation(outline.mesh, corner(face, 0), corner(face, 1), corner(face, 2))) / longest;
    if (height > most) most = height, widest = face;
  }
  if (most < 0) return inside;
  RasterPlace middle{};
  for (int k = 0; k < 3; ++k)
    middle[0] += outline.mesh.x[corner(widest, k)] / (3.0 * outline.mesh.units), middle[1] += outline.mesh.y[corner(widest, k)] / (3.0 * outline.mesh.units);
  inside[widest->info()] = lines.inside(middle);
  std::vector<Triangulation::Face_handle> stack{widest};
  while (!stack.empty()) {
    const auto face = stack.back();
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto next = face->neighbor(k);
      if (triangulation.is_infinite(next) || inside[next->info()] != 2) continue;
      const auto [from, to] = std::minmax({corner(face, Triangulation::ccw(k)), corner(face, Triangulation::cw(k))});
      const auto found = std::equal_range(outline.boundary.begin(), outline.boundary.end(), std::pair{from, to});
      inside[next->info()] = static_cast<std::uint8_t>((inside[face->info()] + (found.second - found.first)) % 2);
      stack.push_back(next);
    }
  }
  return inside;
}

void check_boundary(const Outline& outline, const Triangulation& triangulation) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const auto& edge : triangulation.finite_edges()) {
    const auto [from, to] = std::minmax({edge.first->vertex(Triangulation::ccw(edge.second))->info(), edge.first->vertex(Triangulation::cw(edge.second))->info()});
    if (edge.first->is_constrained(edge.second)) edges.emplace_back(from, to);
  }
  std::sort(edges.begin(), edges.end());
  for (const auto& side : outline.boundary)
    if (!std::binary_search(edges.begin(), edges.end(), side))
      throw Error(ErrorKind::input, "the boundary comes closer to other lines than 1/65536 of a cell: simplify it first");
}

/// Gives each fan of triangles about a vertex but the first a vertex of its own.
void part_fans(TileMesh& mesh) {
  std::vector<std::uint8_t> taken(mesh.x.size(), 0);
  for (std::int32_t start = 0; start < static_cast<std::int32_t>(mesh.origin.size()); ++start) {
    if (mesh.twin[start] >= 0) continue;
    const std::int32_t v = mesh.origin[start];
    if (!taken[v]) {
      taken[v] = 1;
      continue;
    }
    const std::int32_t copy = add_vertex(mesh, mesh.x[v], mesh.y[v], mesh.z[v], mesh.held[v]);
    for (std::int32_t h = start; h >= 0; h = mesh.twin[previous_edge(h)]) mesh.origin[h] = copy;
  }
}

}  // namespace

double corner_height(const TileCells& cells, std::int64_t column, std::int64_t row, double height_step_m) {
  double sum = 0;
  int count = 0;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
    if (is_valid(cells, column + dx, row + dy)) sum += cells(column + dx, row + dy), ++count;
  return round_height(sum / count, height_step_m);
}

TileMesh triangulate_domain(const TileCells& cells, const TileBorder& border, double height_step_m, const DomainLines* lines, double longest_cells) {
  Outline outline;
  if (lines != nullptr) outline.mesh.units = line_units;
  add_border(outline, cells, border);
  add_voids(outline, cells, false, height_step_m, longest_cells);
  add_voids(outline, cells, true, height_step_m, longest_cells);
  if (outline.mesh.x.empty()) return {};
  if (lines != nullptr) add_lines(outline, cells, lines->lines, height_step_m);

  const Triangulation triangulation = triangulate(outline);
  TileMesh mesh = outline.mesh;
  std::vector<std::uint8_t> wanted;
  if (lines != nullptr && lines->inside) {
    check_boundary(outline, triangulation);
    std::int32_t number = 0;
    for (const auto face : triangulation.finite_face_handles()) face->info() = number++;
    wanted = faces_inside(outline, triangulation, *lines);
  }
  std::int32_t count = 0;
  for (const auto face : triangulation.finite_face_handles()) {
    const bool kept = is_inside(outline, cells, face) && (wanted.empty() || wanted[face->info()] == 1);
    face->info() = kept ? count++ : -1;
  }
  mesh.origin.resize(static_cast<std::size_t>(3 * count));
  mesh.twin.assign(mesh.origin.size(), -1);
  mesh.fixed.assign(mesh.origin.size(), 0);
  for (const auto face : triangulation.finite_face_handles()) {
    if (face->info() < 0) continue;
    for (int k = 0; k < 3; ++k) {  // half-edge k leaves corner k; CGAL's edge k is opposite to corner k
      const std::int32_t h = 3 * face->info() + k;
      const int opposite = Triangulation::cw(k);
      mesh.origin[h] = face->vertex(k)->info();
      mesh.fixed[h] = lines != nullptr && face->is_constrained(opposite);
      const auto neighbour = face->neighbor(opposite);
      if (triangulation.is_infinite(neighbour) || neighbour->info() < 0) continue;
      mesh.twin[h] = 3 * neighbour->info() + neighbour->index(face->vertex(Triangulation::ccw(k)));
      mesh.fixed[h] = face->is_constrained(opposite);
    }
  }
  part_fans(mesh);
  return mesh;
}

}  // namespace arete
