#pragma once

#include <cstdint>

#include "core/support/progress.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// A raster made small enough to be drawn, with what was seen on the way.
struct Overview {
  Raster<float> cells;             ///< ceil(width / across) x ceil(height / down)
  std::int64_t across = 1;         ///< cells of the source in one cell of the overview
  std::int64_t down = 1;
  double low_m = 0, high_m = 0;    ///< lowest and highest valid cell of the source; NaN when there is none
  std::int64_t valid = 0;          ///< valid cells of the source
};

/// Averages blocks of across x down cells; the last column and row of blocks may be cut by the border. A block is valid when at
/// least half of its cells are, and then has the mean of those. Reads by parts of about 512 x 512 cells: memory holds the overview
/// and a part per thread. Sums in double, in a fixed order. threads: 0, one per core.
Overview make_overview(const RasterSource& source, std::int64_t across, std::int64_t down, int threads, Progress& progress);

}  // namespace arete
