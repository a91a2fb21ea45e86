#pragma once

#include <cstdint>
#include <string>

#include "gis/dem_file.h"
#include "tools/command.h"

namespace arete::tools {

/// The options of `arete tin` that a set of tiles knows.
struct TinTilesArguments {
  std::string input, output;
  DemReadOptions dem;
  double max_error_m = 0;
  int level = 0, passes = 3;
  bool fill = false;
};

/// Whether an output is a set of tiles for Cesium: it ends in '/' or ".tiles".
bool is_tile_set_path(const std::string& path);

/// Writes a set of tiles (write_terrain_tiles) and says what was made.
void run_tin_tiles(const TinTilesArguments& arguments, const CommonOptions& common);

}  // namespace arete::tools
