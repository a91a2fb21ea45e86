#pragma once

#include <CLI/CLI.hpp>

#include "gis/dem_file.h"

namespace arete::tools {

/// The options of every verb that reads a DEM: --band and --terrain-rgb. `options` must outlive the parsing.
void add_dem_options(CLI::App* verb, DemReadOptions& options);

}  // namespace arete::tools
