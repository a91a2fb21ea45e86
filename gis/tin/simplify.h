#pragma once

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// Makes a mesh that keeps the bound one with fewer triangles that keeps it. Passes over the vertices along their Z-order curve; in
/// each
///   1. a vertex is moved onto one of its neighbours (half-edge collapse) where some elevation of that neighbour lets every cell
///      about both keep the bound: each cell allows an interval of it, and their intersection must not be empty. Of the
///      neighbours that can, the one with the least sum of squared errors is taken, at the least-squares elevation within the interval;
///   2. every vertex moves to the least-squares elevation within its interval;
///   3. edges are flipped where that lowers the sum of squared errors and keeps the bound.
/// Every change is proven exactly (fit_of) before it is made. No change makes a triangle whose height is less than a tenth of its
/// longest edge, unless it was so before. Vertices that are held stay as they are.
/// Cost: a pass looks at each vertex's neighbours' stars, about 100 cells per cell of the tile.
void simplify(TileMesh& mesh, const TileCells& cells, const TileBound& bound, int passes);

}  // namespace arete
