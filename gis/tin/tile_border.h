#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace arete {

/// A vertex on a line of cells: `at` units from the centre of the line's first cell.
struct LineVertex {
  std::int32_t at = 0;
  double z = 0;
  bool operator==(const LineVertex&) const = default;
};
using Polyline = std::vector<LineVertex>;

/// What a line of cells is meshed with.
struct LineBound {
  double error_m = 0;
  double height_step_m = 1.0 / 1024;
  int units = 2;  ///< to a cell, even
  double longest_cells = 1e9;  ///< no side may be longer
};

/// Polylines over a row or column of cells (metres, NaN void), one over each run of valid cells, from its first cell's edge to its
/// last one's, but no further than the centres of the line's own first and last cell. No cell is further off than the bound,
/// vertically, exactly; vertices are few: from each the next lies as far as one straight side keeps the bound (the tunnel
/// of Imai and Iri). The centres of the line's first and last cell, where valid, and the `forced` places inside runs (ascending, in
/// units) are vertices; these have the elevation of the cells. The result depends on the cells alone, so that the two tiles that share
/// the line make the same vertices.
std::vector<Polyline> simplify_line(std::span<const float> cells, const LineBound& bound, std::span<const std::int32_t> forced = {});

/// Height of a polyline at a place inside it.
double height_at(const Polyline& line, std::int32_t at);

}  // namespace arete
