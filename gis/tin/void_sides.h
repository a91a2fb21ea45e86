#pragma once

#include <cstdint>
#include <vector>

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// A side along a void, and the corner of cells nearest to its middle, at which it can be split.
struct VoidSide {
  std::int32_t edge = -1;  ///< a half-edge; -1: none
  std::int32_t length = 0;
  std::int32_t column = 0, row = 0;  ///< of the cell up and left of the corner
};

/// The longest side of a triangle along a void that is longer than a cell.
VoidSide find_void_side(const TileMesh& mesh, std::int32_t triangle);

/// The longest of the triangles about the corners of one, itself among them.
VoidSide find_void_side_about(const TileMesh& mesh, std::int32_t triangle);

/// Makes the corner a vertex at the mean of the cells about it, held. Appends each triangle that is new or changed to `changed`.
void split_void_side(TileMesh& mesh, const TileCells& cells, const TileBound& bound, const VoidSide& side, std::vector<std::int32_t>& changed);

}  // namespace arete
