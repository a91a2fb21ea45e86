#pragma once

#include <cstdint>

#include "gis/tin/make_tin.h"

namespace arete {

/// The TIN with the least bound whose triangles are at most `triangles`, and at least 99 % of them wherever some bound gives so
/// many: bounds are tried, each by meshing the raster, until one does (about six times). options.max_error_m is where the search begins; 0:
/// at a hundredth of the raster's range. Throws Error{usage} where the raster cannot be meshed with so few triangles, saying how many
/// it needs.
Tin make_tin_of_triangles(const RasterSource& raster, std::int64_t triangles, TinOptions options, Progress& progress);

/// The TIN with the largest bound whose RMSE over the valid cells is at most `rmse_m`, and at least 98 % of it wherever some bound
/// gives so much. As above.
Tin make_tin_of_rmse(const RasterSource& raster, double rmse_m, TinOptions options, Progress& progress);

}  // namespace arete
