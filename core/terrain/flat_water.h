#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

/// Side of the square of equal cells that counts as water.
inline constexpr int flat_water_side = 5;

/// How far water reaches from such a square into narrow bays and channels, in cells.
inline constexpr int flat_water_growth = 6;

/// 1 where a cell belongs to a square of 5 x 5 cells of exactly the same elevation, or is joined to one by at most 6 steps through cells of
/// that elevation (in 4 directions): sea and lakes as producers of DEMs flatten them, the only terrain that is level to the last bit.
/// (An opening and a bounded reconstruction, so that single equal neighbours on plains of integer elevations do not count.) A cell
/// depends on the 4 + 6 cells around it. Void cells are not water.
Raster<std::uint8_t> find_flat_water(RasterView<const float> cells);

}  // namespace arete
