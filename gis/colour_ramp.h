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
  std::vector<Colour> table_;
};

/// The names that named_ramp knows, the default first: land, hypsometric, viridis, grey.
const std::vector<std::string>& ramp_names();

/// Throws Error{usage} where the name is none of ramp_names().
ColourRamp named_ramp(const std::string& name);

/// For signed differences: blue below zero, near white at zero (position 0.5), red above. Of the shape of ColorBrewer's RdBu.
ColourRamp difference_ramp();

/// Lightness L of Oklab in [0, 1].
double lightness(Colour colour);

}  // namespace arete
