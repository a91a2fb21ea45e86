#pragma once

#include <cstdint>
#include <vector>

#include "gis/tin/tile_border.h"
#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// The four sides of a tile, each simplified: rows from the left, columns from the top.
struct TileBorder {
  std::vector<Polyline> top, bottom, left, right;
};

/// A first triangulation of what a tile's mesh covers: the squares of its valid cells, cut at the centres of the tile's outer cells. Its
/// vertices are those of the border and the corners of voids (at half cells, at the mean elevation of the valid cells that meet
/// there); all are held. Where two voids touch at a corner, each side has its own vertex there, so that the mesh is a manifold.
/// Constrained Delaunay (CGAL, exact predicates). Empty where no cell is valid.
TileMesh triangulate_domain(const TileCells& cells, const TileBorder& border, double height_step_m);

}  // namespace arete
