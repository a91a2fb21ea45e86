#pragma once

#include <array>

#include "core/terrain/georeference.h"

namespace arete {

/// Metric size of a cell at the centre of a raster. Geographic CRS: lengths of the geodesics across the centre cell on the
/// ellipsoid of the CRS (Karney 2013, through GeographicLib). Projected CRS: the transform times the CRS's linear unit.
/// No CRS: the transform's own numbers, taken as metres; no transform: 1 m.
CellSize cell_size(const GeoReference& geo, Size size);

/// The distance on the ground between two places (x, y) in the CRS of a raster, metres: along the geodesic in a geographic CRS, straight in others, as
/// cell_size.
double ground_distance(const GeoReference& geo, const std::array<double, 2>& from, const std::array<double, 2>& to);

}  // namespace arete
