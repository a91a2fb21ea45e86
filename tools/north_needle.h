#pragma once

#include "gis/image.h"
#include "shaders/camera.h"

namespace arete::tools {

/// Draws a needle that lies flat on the ground, in the lower right corner of a picture, and points as the grid's north does in its middle. Seen from less than
/// 20 degrees above, it is tilted so that it can be read. `rows`: those of the picture from row y on, as wide as it.
void draw_north(Picture& rows, std::int64_t y, std::int64_t picture_height, const Camera& camera, double grid_north_deg);

}  // namespace arete::tools
