#pragma once

#include <array>
#include <vector>

#include "core/terrain/georeference.h"

namespace arete {

/// Metric size of a cell at the centre of a raster. Geographic CRS: lengths of the geodesics across the centre cell on the
/// ellipsoid of the CRS (Karney 2013, through GeographicLib). Projected CRS: the transform times the CRS's linear unit.
/// No CRS: the transform's own numbers, taken as metres; no transform: 1 m.
CellSize cell_size(const GeoReference& geo, Size size);

/// Distances on the ground from the first of these places (x, y in the CRS of a raster) along the others, metres: on geodesics in a geographic CRS, straight in
/// others, as cell_size.
std::vector<double> distances_along(const GeoReference& geo, const std::vector<std::array<double, 2>>& places);

}  // namespace arete
