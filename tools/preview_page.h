#pragma once

#include <string>

#include "gis/dem_file.h"
#include "gis/relief.h"
#include "gis/terrain_page.h"
#include "tools/command.h"

namespace arete::tools {

struct PageArguments {
  std::string input, output;
  std::string compare;         ///< the DEM right of the divider; empty: none
  DemReadOptions reading;      ///< of both
  ReliefOptions relief;        ///< width: samples along the longest side at most, 0: 1280; exaggeration: of the heights too, 0: as the relief
  bool legend = true;
  std::string credit = {};     ///< whose data it is; empty: nobody is named
};

/// Whether `path` ends in .html or .htm.
bool is_page(const std::string& path);

/// A page on which the terrain of a DEM or a tree can be turned about. The other DEM is placed by its georeference. arguments.output is
/// not looked at. Throws Error{format} for a mesh, Error{input} where both do not lie in one CRS or share no ground.
TerrainPage make_preview_page(const PageArguments& arguments, const CommonOptions& common, Progress& progress);

/// Writes that page and prints what it holds.
void write_preview_page(const PageArguments& arguments, const CommonOptions& common);

}  // namespace arete::tools
