#pragma once

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// Greedy insertion (Garland and Heckbert, Fast polygonal approximation of terrains and height fields, CMU-CS-95-181, 1995): while a
/// triangle has a cell beyond the bound, the worst cell of one of the worst triangles becomes a vertex, at its own elevation
/// (rounded to the height step), and the triangulation stays constrained Delaunay. Triangles wait in classes of an eighth of an
/// octave of their error, the last come first within a class. When it ends every cell keeps the bound.
/// Throws Error{format} where no vertices are left to insert and a triangle is too steep for the rounding of the bound.
/// Cost: each cell is looked at about log2(cells per triangle at the end) times.
void insert_greedily(TileMesh& mesh, const TileCells& cells, const TileBound& bound);

}  // namespace arete
