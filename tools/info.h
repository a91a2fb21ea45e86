#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "gis/dem_file.h"
#include "tools/command.h"

namespace arete::tools {

/// What `arete info` says of a file: the same in words and as data.
struct Report {
  std::string text;
  nlohmann::json data;
};

/// The options of `arete info`, of all kinds of file.
struct InfoOptions {
  std::string file;
  DemReadOptions dem;
};

/// A DEM: everything that GDAL opens. Reads it once, for the elevations.
Report describe_dem(const InfoOptions& options, const CommonOptions& common);

}  // namespace arete::tools
