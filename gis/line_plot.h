#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gis/image.h"

namespace arete {

/// Curves over one pair of axes, with a legend at the right.
struct LinePlot {
  struct Series {
    std::string name;                               ///< in the legend; empty: not there
    std::vector<std::pair<double, double>> points = {};  ///< x and y; joined in their order; those that the axes cannot show are left out
    Colour colour = {0, 0, 0, 255};
    bool dashed = false;
    bool strong = false;  ///< drawn thicker
  };
  std::string title = {}, x_title = {}, y_title = {};
  bool log_x = false, log_y = false;
  std::vector<double> x_ticks = {};  ///< empty: round ones
  double y_low = 0, y_high = 0;    ///< where the y axis ends; both 0: where the points do. Lines are cut there
  std::vector<Series> series = {};
  std::string note = {};  ///< under the legend
};

/// Colours that stay apart for the colour-blind (Okabe & Ito, "Color Universal Design", 2008), black first; repeated after the seventh.
Colour plot_colour(std::size_t index);

/// The plot as a picture of 960 x 560 pixels times `scale`. Words need a font (find_font).
Picture draw_line_plot(const LinePlot& plot, int scale = 1);

/// The same drawing as SVG 1.1, which needs nothing from outside, to stand alone or inside HTML.
std::string line_plot_svg(const LinePlot& plot);

}  // namespace arete
