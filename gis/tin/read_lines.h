#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/terrain/georeference.h"
#include "gis/tin/constraint_lines.h"

namespace arete {

/// Lines of a vector file in the plane of a raster.
struct LinesInRaster {
  std::vector<RasterLine> lines;
  std::int64_t features = 0;         ///< with a geometry
  std::int64_t features_inside = 0;  ///< whose bounds meet the raster's
  bool crs_unknown = false;          ///< of the file or of the raster, and not of both: coordinates were taken as they are
};

/// Lines, and the rings of polygons, of all layers of what OGR opens; of one layer where `source` is "path|layer" or "path|layername=layer".
/// Curves become lines, points are passed over. Vertices are transformed into the raster's CRS, what lies between them is straight there: long lines
/// of another CRS should have vertices as close as the curve between them asks for. Where a vertex has no place in the
/// raster's CRS the line is broken.
/// Throws Error{input} where it cannot be opened, has no such layer or no lines, or the CRS cannot be related.
LinesInRaster read_breaklines(const std::string& source, const GeoReference& geo, Size size);

/// The union of the polygons of a file, as rings: first place = last, no place inside an odd number of them but those inside a polygon.
/// Polygons that are not valid are made so (GEOS). Throws as above, and Error{input} where a vertex has no place in the raster's CRS.
LinesInRaster read_boundary(const std::string& source, const GeoReference& geo, Size size);

}  // namespace arete
