#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/terrain/ground_style.h"
#include "gis/colour_ramp.h"
#include "gis/drape_picture.h"
#include "gis/image.h"

namespace arete {

/// What stands under a map.
struct Legend {
  struct Swatch {
    Picture sample;
    std::string label;
  };
  std::string title;             ///< over the colour bar
  double low = 0, high = 1;      ///< values at the ends of the colour bar; NaN: no bar
  std::string unit = "m";
  std::vector<std::pair<double, std::string>> marks;  ///< along the bar, value and word; none: round numbers with the unit
  double metres_per_pixel = 0;   ///< of the map, for the scale bar; 0: none
  std::string scale_note;        ///< over the scale bar: where it is true, if not everywhere
  std::vector<Swatch> swatches;  ///< no data, water...
  std::string note;              ///< small, last
};

/// Round numbers (1, 2 or 5 times a power of ten) between low and high, about `wanted` of them, rising.
std::vector<double> round_ticks(double low, double high, int wanted);

/// The longest length of 1, 2 or 5 times a power of ten that is not above `longest`. longest > 0.
double round_length(double longest);

/// A number with as many decimals as a step between ticks needs.
std::string format_tick(double value, double step);

/// Turns a legend of heights, its title being about them, into one of what the style shows: slopes from 0 to the steepest or the four directions, in the colours
/// of ramp_of; and names the interval of contours in the note.
void style_legend(Legend& legend, const GroundStyle& style, double steepest_deg);

/// Names the raster that lies over the ground. Where it hides all of the ground there is no bar of the ground's colours.
void drape_legend(Legend& legend, const DrapePicture& drape, const std::string& path);

/// Of the numbers that the raster shows, in viridis; for drape.values.
Legend value_legend(const DrapePicture& drape, const std::string& path);

/// The colours of what is told; `heights` for heights.
ColourRamp ramp_of(GroundColour colour, const ColourRamp& heights);

/// A white strip of that width, as high as it needs: colour bar with ticks, scale bar, swatches, note. Without a font
/// (find_font) the bars are drawn and the words are missing.
Picture draw_legend(const Legend& legend, const ColourRamp& ramp, std::int64_t width);

/// The em height in pixels that suits a picture of that width.
int font_size_for(std::int64_t width);

/// Diagonal pale hatching: the sign of cells without data.
Picture hatching(std::int64_t width, std::int64_t height);

}  // namespace arete
