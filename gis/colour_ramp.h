#pragma once

#include <string>
#include <vector>

#include "gis/image.h"

namespace arete {

/// A sequence of colours from the lowest to the highest value.
class ColourRamp {
 public:
  /// Through the colours given (two or more, as #rrggbb). The way between them is straight in Oklab (B. Ottosson, "A perceptual
  /// color space for image processing", 2020) and walked at an even pace, so that equal steps of height look equally different.
  explicit ColourRamp(const std::vector<std::string>& colours);
  /// `position` in [0, 1]; beyond it the end colour.
  Colour at(double position) const;

 private:
  friend ColourRamp aspect_ramp();
  ColourRamp() = default;
  std::vector<Colour> table_;
};

/// The names that named_ramp knows, the default first: land, hypsometric, viridis, grey.
const std::vector<std::string>& ramp_names();

/// Throws Error{usage} where the name is none of ramp_names().
ColourRamp named_ramp(const std::string& name);

/// For signed differences: blue below zero, near white at zero (position 0.5), red above. Of the shape of ColorBrewer's RdBu.
ColourRamp difference_ramp();

/// For slopes: pale where flat, over yellow and red to a dark violet where steepest; darkens all the way.
ColourRamp slope_ramp();

/// For the compass direction that ground faces: position is degrees from north, clockwise, over 360. Cyclic: blue in the north, green in the east, orange in the
/// south, rose in the west, all of the same lightness (Oklab) and saturation.
ColourRamp aspect_ramp();

/// Of ground that faces nowhere: grey of the lightness of aspect_ramp().
Colour flat_colour();

/// Lightness L of Oklab in [0, 1].
double lightness(Colour colour);

}  // namespace arete
