#pragma once

#include <cstdint>

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// Splits the triangles with the largest errors at their worst cell, which becomes a vertex, while the bound is kept and the sum
/// of squared errors falls, until so many are split: each makes two triangles more. For a mesh that may have more triangles than its bound needs.
void split_worst(TileMesh& mesh, const TileCells& cells, const TileBound& bound, std::int64_t splits);

}  // namespace arete
