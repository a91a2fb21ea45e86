#pragma once

#include "core/terrain/raster.h"

namespace arete {

/// How many cells beyond the reach lend support: so the farthest cell that is continued still sees three lines of cells, which fix a plane.
inline constexpr int extend_support = 2;

/// Continues the terrain into its voids, for filters that need whole neighbourhoods: a void cell within `reach` cells (Chebyshev) of
/// a valid one takes the value at its place of the plane fitted to the valid cells within reach + extend_support, weighted by
/// 1 / distance^4; of their mean where they do not fix a plane. A plane is continued exactly. Void cells farther away stay void.
///
/// `known` and `out` have one size and may not overlap. A cell of `out` depends on the cells within reach + extend_support of it, so a
/// window is the same as the part of the whole where it has that margin. Cost: (2 (reach + 2) + 1)^2 per void cell near valid ones.
void extend_into_voids(RasterView<const float> known, int reach, RasterView<float> out);

}  // namespace arete
