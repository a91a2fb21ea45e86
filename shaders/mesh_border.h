#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"
#include "shaders/triangle_mesh.h"

namespace arete {

/// A side that one triangle alone has, which lies on the left of the way from one vertex to the other.
struct BorderSide {
  std::uint32_t from = 0, to = 0;
  bool hole = false;  ///< its loop has the mesh around it, not inside; or lies in one that has
  bool operator==(const BorderSide&) const = default;
};

/// The border of a mesh, loop after loop; where loops touch in a vertex, the side to the vertex of the lowest index follows. Time O(n log n), memory 32 MB and
/// what the border takes. Indices below 2^31. Islands in holes are not told from other pieces yet.
std::vector<BorderSide> find_border(const TriangleMesh& mesh);

/// Where the loop ends that begins at that side.
std::size_t end_of_loop(const std::vector<BorderSide>& border, std::size_t first);

/// A grid over a mesh, row 0 in the north. `x`, `y`: metres, its north-west corner.
struct MeshGrid {
  Size size;
  double x = 0, y = 0;
  CellSize cell;
};

/// Cells that lie under holes: all that a hole touches, but for those that the border around the mesh touches. Empty where there is no hole. Says of islands,
/// of which more than half of the vertices lie in cells whose middle is in a hole, that they are in one.
Raster<std::uint8_t> cells_of_holes(const TriangleMesh& mesh, const MeshGrid& grid, std::vector<BorderSide>& border);

}  // namespace arete
