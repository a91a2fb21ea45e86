#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/terrain/raster.h"
#include "shaders/terrain_scene.h"

namespace arete {

/// A picture and its halves, quarters... down to one pixel, in one texture: so that a shader chooses a level for each pixel by
/// itself, where drivers choose one for 2 x 2 pixels together, whatever surfaces they see.
struct PictureAtlas {
  Size size;
  std::vector<std::array<std::uint8_t, 4>> rgba;  ///< sRGB of colours times opacity, and opacity
  /// Level k has its first row there; level 0 in column 0, the others in the column after level 0. Pixel (x, y) of level k is the
  /// mean, in linear light, of 2^k x 2^k pixels from (x 2^k, y 2^k) on, those at the right and bottom repeated. Sides are
  /// ceil(side / 2^k).
  std::vector<std::int32_t> rows;
};

PictureAtlas make_atlas(const GroundPicture& picture, int threads);

}  // namespace arete
