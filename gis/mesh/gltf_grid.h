#pragma once

#include <array>
#include <cstdint>

#include "gis/mesh/mesh.h"

namespace arete {

/// Along one axis of the mesh, in its units.
struct GltfAxis {
  double offset = 0;     ///< translation of the whole mesh: a multiple of 16
  double reach = 1;      ///< a power of two: positions lie in [-reach, reach) from the translation of their node
  double step = 1;       ///< of the grid: a power of two
  bool in_cells = false; ///< the nodes lie in cells of size `reach`; else there is one cell around the offset
};

/// The grid to which glTF positions are rounded, axes x, y, z of the mesh. Places on it are counted in steps from the offset.
struct GltfGrid {
  std::array<GltfAxis, 3> axes;
};

/// Of a mesh within these bounds. A float32 holds the multiples of the step up to 2^24 of them. Draco's quantiser computes in float32
/// too and adds a half, which is exact up to 2^23 steps from one end to the other, has one step for all axes, and its
/// options keep six decimals of the range, which are all that a float32 has from a reach of 16 on.
GltfGrid gltf_grid(const MeshBounds& bounds, bool draco);

}  // namespace arete
