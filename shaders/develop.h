#pragma once

#include <cstdint>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// Rows of a picture as the camera gets them: linear light in the primaries of sRGB, and opacity. Row 0 at the top.
struct LightRows {
  std::int64_t y = 0;  ///< the first of them in the picture
  Size size;
  std::vector<float> rgba;
};

/// sRGB of 8 bits per sample, size.cells() * 4 of them, with noise of one step against banding that depends on the place in the picture alone. Light beyond
/// [0, 1] is clipped.
void develop(const LightRows& rows, int threads, std::uint8_t* rgba);
/// sRGB of 16 bits per sample, rounded.
void develop(const LightRows& rows, int threads, std::uint16_t* rgba);

}  // namespace arete
