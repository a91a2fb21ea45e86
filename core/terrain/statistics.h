#pragma once

#include <cstdint>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// Of the valid cells of a terrain, in metres. All zero where every cell is void.
struct ElevationStatistics {
  std::int64_t cells = 0;
  std::int64_t valid = 0;
  double lowest = 0;
  double highest = 0;
  double mean = 0;
  double deviation = 0;  ///< standard deviation of the population
  double void_share() const { return cells == 0 ? 0 : 1 - static_cast<double>(valid) / static_cast<double>(cells); }
};

/// Reads the terrain once, in strips of at most 2^20 cells (one row where rows are longer): memory does not grow with
/// the raster. Each strip's mean and squares are taken in two passes in double and joined in order (Chan, Golub & LeVeque 1983), so
/// that a large mean costs no digits. Throws what `source` throws; progress counts cells.
ElevationStatistics elevation_statistics(const RasterSource& source, Progress& progress);

/// The value below which that share (0 to 1) of the values lies, to the nearest of them. At least one value; changes their order.
double percentile(std::vector<float>& values, double share);

}  // namespace arete
