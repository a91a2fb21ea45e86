#pragma once

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// A triangle between neighbouring cells is too steep for the displacement.
struct TooSteep {};

/// Greedy insertion (Garland and Heckbert, Fast polygonal approximation of terrains and height fields, CMU-CS-95-181, 1995): while a
/// triangle has a cell beyond the bound, the worst cell of one of the worst triangles becomes a vertex, at its own elevation
/// (rounded to the height step), and the triangulation stays constrained Delaunay. Triangles wait in classes of an eighth of an
/// octave of their error, the last come first within a class. When it ends every cell keeps the bound. Triangles
/// with an edge that is too long are split first, near their middle. Sides along voids are split where triangles beside them are too steep for the
/// displacement.
/// Throws TooSteep.
/// Cost: each cell is looked at about log2(cells per triangle at the end) times.
void insert_greedily(TileMesh& mesh, const TileCells& cells, const TileBound& bound);

}  // namespace arete
