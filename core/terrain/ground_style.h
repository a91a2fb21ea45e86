#pragma once

namespace arete {

/// What the colour of the ground tells.
enum class GroundColour {
  height,
  slope,   ///< how steep it is, in degrees
  aspect,  ///< the compass direction that it faces, downhill; flat ground is grey
};

inline constexpr double suitable_interval = -1;

/// How ground is coloured, and the lines on it.
struct GroundStyle {
  GroundColour colour = GroundColour::height;
  double contour_interval_m = 0;  ///< metres from one contour to the next, from 0 up and down; every fifth is thicker; 0: no
                                  ///< contours; suitable_interval: what suits the ground that is drawn
  bool drape = true;  ///< a picture laid over the ground is shown, where there is one
  bool operator==(const GroundStyle&) const = default;
};

/// Metres between contours that suit ground of that relief (highest less lowest, metres): the round number (1, 2 or 5 times a
/// power of ten) nearest to a 24th of it by ratio; 1 where the relief is 0 or less.
double contour_interval(double relief_m);

/// With the interval of contours as a number.
GroundStyle settle(GroundStyle style, double relief_m);

/// Where a scale of slopes ends: the first of 2, 5, 10, 20, 30, 45, 60, 75 and 90 degrees that is not less.
double slope_scale_deg(double steep_deg);

/// Ground is grey, not coloured by the direction that it faces, where it is flatter than the first share of the end of the scale
/// of slopes; from the second on it has its full colour.
inline constexpr double flat_share = 0.01, facing_share = 0.04;

}  // namespace arete
