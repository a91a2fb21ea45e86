#pragma once

#include "core/terrain/georeference.h"

namespace arete {

/// Metric size of a cell at the centre of a raster. Geographic CRS: lengths of the geodesics across the centre cell on the
/// ellipsoid of the CRS (Karney 2013, through GeographicLib). Projected CRS: the transform times the CRS's linear unit.
/// No CRS: the transform's own numbers, taken as metres; no transform: 1 m.
CellSize cell_size(const GeoReference& geo, Size size);

}  // namespace arete
