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

/// A tree at that level, each of which has half the cells along each side. Throws as DemReader and ElevationTree, and Error{usage} where
/// there is no such level.
ElevationInput open_elevations(const std::string& path, const DemReadOptions& options, int threads, int level = 0);

}  // namespace arete::tools
