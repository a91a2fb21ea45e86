#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/command.h"
#include "tools/dem_options.h"

namespace arete::tools {

struct ProfileArguments {
  std::string input, output, ramp = "land";
  DemReadOptions dem;
  std::vector<double> line;  ///< x1, y1, x2, y2 in the CRS of the DEM; empty: through the middle, from left to right
  std::int64_t width = 0;    ///< of the drawing in pixels; 0: 1600
  double exaggeration = 0;   ///< 0: as much as fills the drawing
};

/// Draws the elevations under a line.
void run_preview_profile(const ProfileArguments& arguments, const CommonOptions& common);

}  // namespace arete::tools
