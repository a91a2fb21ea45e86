#pragma once

#include <cmath>
#include <cstdint>
#include "core/terrain/raster.h"

namespace arete {

/// Fractal relief of a few hundred metres, for the tests of the codec.
inline Raster<float> codec_terrain(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      double z = 500;
      for (int octave = 0; octave < 7; ++octave) {
        const double f = 0.01 * (1 << octave), a = 200.0 / (1 << octave);
        z += a * std::sin(f * static_cast<double>(x) + 1.3 * octave) * std::cos(f * 1.17 * static_cast<double>(y) + 0.7 * octave);
      }
      cells(x, y) = static_cast<float>(z);
    }
  return cells;
}

}  // namespace arete
