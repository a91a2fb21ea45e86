#pragma once

#include "core/terrain/raster.h"

namespace arete {

/// Area average: each cell of the result is the mean of its factor x factor block. Rows and columns beyond a multiple of
/// `factor` are dropped. A block with any void cell is void. Result: floor(width/factor) x floor(height/factor). Sums in double.
Raster<float> area_average(RasterView<const float> fine, int factor);

/// Bicubic interpolation with Catmull-Rom weights (Keys 1981, a = -1/2) onto a grid `factor` times finer, cell areas
/// aligned (fine centre (i + 1/2)/factor - 1/2 in coarse cells). Beyond the border the edge cell repeats. A result cell that
/// needs a void cell is void only when the coarse cell it lies in is void; elsewhere a void neighbour takes that cell's value.
Raster<float> upsample_bicubic(RasterView<const float> coarse, int factor);

}  // namespace arete
