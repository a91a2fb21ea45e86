#pragma once

#include <cstdint>
#include <vector>

#include "core/terrain/raster.h"
#include "shaders/camera.h"

namespace arete {

/// A part of a picture as the GPU draws it: linear light in the primaries of sRGB, and opacity, as half floats (IEEE 754 binary16) with row 0 at the bottom,
/// `supersampling` pixels aside for each of the picture.
struct DrawnPart {
  const std::vector<std::uint16_t>& halves;
  int supersampling;
  PicturePart part;
};

/// Rows of a picture: the same light, a pixel each, row 0 at the top.
struct LightRows {
  std::int64_t y = 0;  ///< the first of them in the picture
  Size size;
  std::vector<float> rgba;
};

/// Averages the pixels of a part into the rows that it lies in.
void average(const DrawnPart& drawn, int threads, LightRows& rows);

/// sRGB of 8 bits per sample, with noise of one step against banding that depends on the place in the picture alone. Light beyond [0, 1] is clipped.
/// `rgba` is the first pixel of the whole picture for a part, and of the rows for rows; both give the same bytes.
void develop(const DrawnPart& drawn, int threads, std::int64_t picture_width, std::uint8_t* rgba);
void develop(const LightRows& rows, int threads, std::uint8_t* rgba);
/// sRGB of 16 bits per sample, rounded.
void develop(const LightRows& rows, int threads, std::uint16_t* rgba);

}  // namespace arete
