#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/terrain/raster.h"

namespace arete {

/// Whether a sample stands for the cell (area) or for its centre point, as GeoTIFF tags it. The transform is always that of the
/// outer corner of the first cell; registration only says what the producer meant and is written back as it was found.
enum class Registration { area, point };

/// Where a raster lies on Earth. Plain data, no CRS library behind it.
struct GeoReference {
  /// x = t[0] + column t[1] + row t[2], y = t[3] + column t[4] + row t[5], at the outer corner of a cell (GDAL's order).
  /// Nullopt where the file has none: then cells are taken as 1 unit wide.
  std::optional<std::array<double, 6>> transform;
  std::string crs_wkt;              ///< WKT2, with the vertical part; empty where unknown
  std::string vertical_unit = "m";  ///< of the source's elevations, as its file names it
  double metres_per_unit = 1;       ///< one vertical unit in metres
  std::optional<double> nodata;     ///< the source's own value, in its own unit; core uses NaN
  Registration registration = Registration::area;
};

/// Metric size of a cell at the centre of a raster (or at the latitude that was asked for).
struct CellSize {
  double x_m = 1;
  double y_m = 1;
};

/// Column and row (fractions, from the outer corner of the first cell) of a place (x, y), by a transform whose cells have an area.
std::array<double, 2> cell_at(const std::array<double, 6>& transform, double x, double y);

/// The same extent, exactly, with cells `factor` times smaller.
GeoReference refine(const GeoReference& geo, int factor);
/// The same origin with cells `factor` times larger.
GeoReference coarsen(const GeoReference& geo, int factor);
/// The georeference of a window of the raster.
GeoReference crop(const GeoReference& geo, const Window& window);

}  // namespace arete
