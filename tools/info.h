#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "gis/dem_file.h"
#include "tools/command.h"

namespace arete::tools {

/// What `arete info` says of a file: the same in words and as data.
struct FileReport {
  std::string text;
  nlohmann::json data;
};

/// The options of `arete info`, of all kinds of file.
struct InfoOptions {
  std::string file;
  DemReadOptions dem;
  std::string sheet;  ///< where to draw the atoms of a dictionary; empty: nowhere
};

/// A DEM: everything that GDAL opens. Reads it once, for the elevations.
FileReport describe_dem(const InfoOptions& options, const CommonOptions& common);

/// A dictionary of atoms (.atoms). Draws them where the options say.
FileReport describe_dictionary(const InfoOptions& options, const CommonOptions& common);

/// A mesh: reads it three times, for its bounds, its area and its edges.
FileReport describe_mesh(const InfoOptions& options, const CommonOptions& common);

/// A tree of elevations (.sct): its directory, no node.
FileReport describe_tree(const InfoOptions& options, const CommonOptions& common);

}  // namespace arete::tools
