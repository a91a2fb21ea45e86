#pragma once

#include <cstdint>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

enum class DrawMode {
  lit,        ///< colours of heights under sun, sky and haze
  wireframe,  ///< the same with the sides of its triangles
  levels,     ///< a colour for each level of the quadtree
  coverage,   ///< white where there is terrain, transparent black elsewhere; as one sample of each pixel shows it
};

/// Of light that is as bright as white, and brighter: rolled off, as a picture for the eye needs, or kept, as the scene has it.
enum class Highlights { roll_off, kept };

/// A picture with what it took.
struct Frame {
  Size size;
  std::vector<std::uint8_t> rgba;  ///< sRGB, row 0 at the top
  std::int64_t patches = 0;
  std::int64_t triangles = 0;      ///< of all patches together
  std::int64_t tiles_loaded = 0;   ///< that were not on the GPU already
};

}  // namespace arete
