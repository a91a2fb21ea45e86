#include "tools/dem_options.h"

namespace arete::tools {

void add_dem_options(CLI::App* verb, DemReadOptions& options) {
  verb->add_option("--band", options.band, "Band of the elevations, counted from 1 (default: 1)")->check(CLI::Range(1, 65535));
  verb->add_flag("--terrain-rgb", options.terrain_rgb, "The DEM is a Mapbox terrain-RGB picture");
}

}  // namespace arete::tools
