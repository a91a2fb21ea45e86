#pragma once

#include <cstdint>
#include <vector>

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// A triangle that a cell is beyond the bound of, once it is displaced.
struct DisplacedExcess {
  std::int32_t triangle = 0;
  double beyond_m = 0;   ///< of its worst cell
  bool on_side = false;  ///< that cell lies on a side of the tile
};

/// All of them; none: every cell keeps the bound, those on the sides of the tile too.
///
/// A displaced triangle passes over a place within `aside` (moves_aside) of the triangle, at the height that the triangle has within `aside` of that place,
/// and sags. So each triangle answers for all cells within `aside` of it, along x and y, not for those inside it alone: cells of a flat triangle may come to
/// lie under a steep one beside it. In meshes of finer units than half cells, which may end anywhere, cells in no triangle are left out.
/// Cost: as measuring every cell once.
std::vector<DisplacedExcess> find_displaced_excesses(const TileMesh& mesh, const TileCells& cells, const TileBound& bound);

}  // namespace arete
