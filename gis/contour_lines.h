#pragma once

#include <cstdint>

#include "core/terrain/raster.h"
#include "gis/image.h"

namespace arete {

/// Draws contours over a map of those heights, whatever its size: smooth lines of about a pixel at the multiples of the interval,
/// every fifth thicker. Heights are bilinear between the centres of cells. Lines fade where they would lie less than 5 pixels
/// apart, and are gone below 2.5. There are none in cells whose `bare` (of the size of the heights) is not 0, and none beside
/// voids. interval_m > 0. The same picture for any number of threads.
void draw_contours(Picture& map, RasterView<const float> heights, RasterView<const std::uint8_t> bare, double interval_m,
                   int threads = 0);

}  // namespace arete
