#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

/// 1 where a picture shows water: cells at or below 0 m whose neighbours (of eight, those inside the raster) all have exactly their height, and the cells beside
/// them, which have it too. Depends on the cells at most two away. Void cells are no water. Not for codecs: find_flat_water (flat_water.h) finds lakes too.
Raster<std::uint8_t> find_sea(RasterView<const float> cells);

}  // namespace arete
