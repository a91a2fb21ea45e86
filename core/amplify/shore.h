#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

/// Levels the fine cells of flat water, and lifts what dips below the water in the cells on its shore: there the relief above the
/// water is scaled so that the cell keeps its mean. `coarse` and `water` have one cell of margin around the window that `fine`
/// covers. Cells below a neighbouring water level are left as they are.
void settle_shores(RasterView<const float> coarse, RasterView<const std::uint8_t> water, int factor, RasterView<float> fine);

}  // namespace arete
