#pragma once

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// Makes of a mesh that keeps the bound one with fewer triangles that keeps it. Each pass goes over the vertices along their Z-order curve:
/// a vertex is moved onto one of its neighbours (half-edge collapse) where some elevation of that neighbour lets every cell about
/// both keep the bound: each cell allows an interval of it, and their intersection must not be empty. The first
/// neighbour that can is taken, at the least-squares elevation within the interval. Between passes every
/// vertex moves to the least-squares elevation within its interval, and edges are flipped where that lowers the sum of squared errors
/// and keeps the bound; both make room for the next. The third pass and later ones try only vertices beside which the one
/// before removed something. At the end every triangle is proven exactly, and gets vertices where rounding left a cell beyond
/// the bound.
///
/// No change makes a triangle whose height is less than a tenth of its longest edge, unless it was so before, or an edge that is too
/// long. Vertices that are held stay as they are.
/// Cost: each of the first two passes looks at each cell about 50 times.
void simplify(TileMesh& mesh, const TileCells& cells, const TileBound& bound, int passes);

}  // namespace arete
