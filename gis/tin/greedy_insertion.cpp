#include "gis/tin/greedy_insertion.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/error.h"
#include "gis/tin/heights.h"
#include "gis/tin/triangle_errors.h"
#include "gis/tin/void_sides.h"

namespace arete {
namespace {

/// The worst cell of a triangle, where one is beyond the bound.
struct Candidate {
  float error = 0;  ///< metres; 0: every cell keeps the bound, and no edge is too long
  std::int32_t row = 0, column = 0;
};

bool is_corner(const TileMesh& mesh, std::int32_t vertex, std::int32_t row, std::int32_t column) {
  return mesh.x[vertex] == column * mesh.units && mesh.y[vertex] == row * mesh.units;
}

/// The cell nearest to the middle of a triangle that is not its corner, however little it is off; `error` is above all others, or 0 where
/// there is none.
Candidate middle_cell(const TileMesh& mesh, const TileCells& cells, std::int32_t a, std::int32_t b, std::int32_t c) {
  const double x = (static_cast<double>(mesh.x[a]) + mesh.x[b] + mesh.x[c]) / 3, y = (static_cast<double>(mesh.y[a]) + mesh.y[b] + mesh.y[c]) / 3;
  double nearest = std::numeric_limits<double>::infinity();
  Candidate candidate;
  for_each_span(mesh, cells, a, b, c, [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    for (std::int32_t column = first; column <= last; ++column) {
      const double distance = std::hypot(column * mesh.units - x, row * mesh.units - y);
      if (distance >= nearest || is_corner(mesh, a, row, column) || is_corner(mesh, b, row, column) || is_corner(mesh, c, row, column)) continue;
      nearest = distance;
      candidate = {std::numeric_limits<float>::max(), row, column};
    }
  });
  return candidate;
}

Candidate worst_cell(const TileMesh& mesh, const TileCells& cells, std::int32_t triangle, const TileBound& bound) {
  const auto [a, b, c] = mesh.corners(triangle);
  const TrianglePlane plane = plane_of(mesh, a, b, c);
  double worst = -1;
  Candidate candidate;
  for_each_difference(mesh, cells, a, b, c, plane, [&](double difference, std::int32_t row, std::int32_t column) {
    if (std::abs(difference) <= worst) return;
    worst = std::abs(difference);
    candidate.row = row;
    candidate.column = column;
  });
  if (is_too_long(mesh, a, b, c, bound)) {
    const Candidate middle = middle_cell(mesh, cells, a, b, c);
    if (middle.error > 0) return middle;
  }
  if (worst < 0 || worst <= allowance(mesh, plane, a, b, c, bound)) return {};
  if (mesh.units != 2) {
    const WorstCell beyond = worst_beyond(mesh, cells, a, b, c, plane, bound);
    if (beyond.difference < 0) return {};
    worst = beyond.difference, candidate.row = beyond.row, candidate.column = beyond.column;
  }
  candidate.error = std::max(static_cast<float>(worst / plane.area2), std::numeric_limits<float>::min());
  return candidate;
}

/// Triangles by the size of their error: eight classes to an octave, from the bits of the float.
class Waiting {
 public:
  void add(std::int32_t triangle, float error) {
    const std::size_t level = std::bit_cast<std::uint32_t>(error) >> 20;
    levels_[level].push_back({triangle, error});
    top_ = std::max(top_, level);
  }
  struct Entry {
    std::int32_t triangle;
    float error;
  };
  bool take(Entry& entry) {
    while (levels_[top_].empty()) {
      if (top_ == 0) return false;
      --top_;
    }
    entry = levels_[top_].back();
    levels_[top_].pop_back();
    return true;
  }

 private:
  std::array<std::vector<Entry>, 1 << 11> levels_;  // of the sign (0), the exponent and three bits
  std::size_t top_ = 0;
};

/// The half-edge of a triangle that leaves the corner at the candidate; -1: the candidate is no corner.
std::int32_t edge_from(const TileMesh& mesh, std::int32_t triangle, const Candidate& candidate) {
  for (std::int32_t h = 3 * triangle; h < 3 * triangle + 3; ++h)
    if (is_corner(mesh, mesh.origin[h], candidate.row, candidate.column)) return h;
  return -1;
}

/// A triangle that is too steep, its worst cell one of its corners: a corner that a simplification moved gets its own elevation back;
/// else its side along a void is split; else a cell beside the triangle is found, which makes it another one; else a side along
/// a void that is close by is split.
void ease(TileMesh& mesh, const TileCells& cells, const TileBound& bound, std::int32_t corner, std::int32_t& triangle, Candidate& candidate,
          std::vector<std::int32_t>& changed) {
  const std::int32_t v = mesh.origin[corner];
  const double own = round_height(cells(candidate.column, candidate.row), bound.height_step_m);
  candidate.error = 0;
  if (mesh.z[v] != own && !mesh.held[v]) {
    mesh.z[v] = own;
    return append_star(mesh, corner, changed);
  }
  const std::int32_t steep = triangle;
  changed.push_back(steep);
  if (const VoidSide side = find_void_side(mesh, steep); side.edge >= 0) return split_void_side(mesh, cells, bound, side, changed);
  for (std::int32_t h = 3 * steep; h < 3 * steep + 3 && candidate.error == 0; ++h) {
    if (mesh.twin[h] < 0) continue;
    triangle = mesh.twin[h] / 3;
    const auto [a, b, c] = mesh.corners(triangle);
    candidate = middle_cell(mesh, cells, a, b, c);
  }
  if (candidate.error > 0) return;
  const VoidSide side = find_void_side_about(mesh, steep);
  if (side.edge < 0) throw TooSteep();
  split_void_side(mesh, cells, bound, side, changed);
}

}  // namespace

void insert_greedily(TileMesh& mesh, const TileCells& cells, const TileBound& bound) {
  std::vector<Candidate> candidates;
  std::vector<std::int32_t> changed;
  Waiting waiting;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) changed.push_back(t);
  const auto look_at_changed = [&] {
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    candidates.resize(static_cast<std::size_t>(mesh.triangles()));
    for (const std::int32_t t : changed) {
      candidates[t] = worst_cell(mesh, cells, t, bound);
      if (candidates[t].error > 0) waiting.add(t, candidates[t].error);
    }
    changed.clear();
  };
  look_at_changed();
  for (Waiting::Entry entry; waiting.take(entry);) {
    Candidate candidate = candidates[entry.triangle];
    if (candidate.error != entry.error) continue;  // it has changed since
    std::int32_t triangle = entry.triangle;
    if (const std::int32_t corner = edge_from(mesh, triangle, candidate); corner >= 0) {
      ease(mesh, cells, bound, corner, triangle, candidate, changed);
      if (candidate.error == 0) {
        look_at_changed();
        continue;
      }
    }
    const double z = round_height(cells(candidate.column, candidate.row), bound.height_step_m);
    const std::int32_t v = add_vertex(mesh, candidate.column * mesh.units, candidate.row * mesh.units, z, false);
    if (mesh.units != 2) {
      // The cell may lie beyond the triangle by as little as a file's noise: what triangle it is in looks after it.
      triangle = find_triangle(mesh, triangle, v);
      if (triangle < 0 || edge_from(mesh, triangle, candidate) >= 0)
        throw Error(ErrorKind::input, "lines leave a triangle thinner than a ten-millionth of a cell: simplify them first");
    }
    insert_vertex(mesh, triangle, v, changed);
    look_at_changed();
  }
}

}  // namespace arete
