#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "gis/tin/constraint_lines.h"
#include "gis/tin/tile_border.h"
#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// The four sides of a tile, each simplified: rows from the left, columns from the top.
struct TileBorder {
  std::vector<Polyline> top, bottom, left, right;
};

/// The lines of a tile.
struct DomainLines {
  TileLines lines;
  /// Whether a place (columns, rows from the centre of the tile's first cell) lies inside the boundary; asked once a tile, far from the boundary. Empty: no
  /// boundary.
  std::function<bool(const RasterPlace&)> inside;
};

/// A first triangulation of what a tile's mesh covers: the squares of its valid cells, cut at the centres of the tile's outer cells. Its
/// vertices are those of the border and the corners of voids (at half cells, at the mean elevation of the valid cells that meet
/// there); all are held. Where two voids touch at a corner, each side has its own vertex there, so that the mesh is a manifold.
/// Constrained Delaunay (CGAL, exact predicates). Empty where no cell is valid.
///
/// With lines, their pieces over valid cells are fixed edges, cut where they enter and leave voids; the units are line_units (also those of
/// the border). Their ends are at the elevation between the cells (bilinear, of those that are valid). What lies outside the boundary is left
/// out. There may be vertices without triangle. Throws Error{input} where pieces cross each other.
///
/// No side along a void is longer than `longest_cells`, at least 1: longer ones have vertices at corners of cells between.
TileMesh triangulate_domain(const TileCells& cells, const TileBorder& border, double height_step_m, const DomainLines* lines = nullptr,
                            double longest_cells = any_length);

/// The elevation of a vertex where four cells meet, given the one up and left of it: the mean of those that are valid; at least one must be.
double corner_height(const TileCells& cells, std::int64_t column, std::int64_t row, double height_step_m);

}  // namespace arete
