#pragma once

#include <string>

#include "gis/dem_file.h"
#include "gis/relief.h"
#include "tools/command.h"

namespace arete::tools {

struct PageArguments {
  std::string input, output;
  std::string compare;         ///< the DEM right of the divider; empty: none
  DemReadOptions reading;      ///< of both
  ReliefOptions relief;        ///< width: samples along the longest side at most, 0: 1280; exaggeration: of the heights too, 0: as the relief
  bool legend = true;
};

/// Whether `path` ends in .html or .htm.
bool is_page(const std::string& path);

/// Writes a page on which the terrain of a DEM or a tree can be turned about (gis/terrain_page.h) and prints what it holds. The other DEM
/// is placed by its georeference. Throws Error{format} for a mesh, Error{input} where both do not lie in one CRS or share no ground.
void write_preview_page(const PageArguments& arguments, const CommonOptions& common);

}  // namespace arete::tools
