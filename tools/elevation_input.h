#pragma once

#include <memory>
#include <string>

#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "gis/dem_file.h"

namespace arete::tools {

/// Elevations of whatever holds them: a tree (.sct), or a DEM that GDAL opens.
struct ElevationInput {
  std::unique_ptr<RasterSource> source;
  GeoReference geo;
};

/// Throws as DemReader and ElevationTree.
ElevationInput open_elevations(const std::string& path, const DemReadOptions& options, int threads);

}  // namespace arete::tools
