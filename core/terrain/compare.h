#pragma once

#include <cstdint>
#include <optional>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"

namespace arete {

struct CompareOptions {
  CellSize cell;              ///< of both rasters, for slopes
  std::int64_t border = 0;    ///< leaves out that many cells along each side
  int factor = 0;             ///< for the consistency; below 2 none is made
  int threads = 0;            ///< 0: one per core; the result is the same for any number
};

/// How a result differs from its reference, over the cells that are valid in both and inside the border ("compared cells").
/// Error = result - reference. Where no cell is compared the real numbers are NaN.
struct Comparison {
  std::int64_t cells = 0;           ///< compared
  std::int64_t only_reference = 0;  ///< valid in the reference, void in the result, inside the border
  std::int64_t only_result = 0;

  double bias_m = 0, rmse_m = 0, mae_m = 0;
  double max_m = 0;                       ///< largest |error|, at the first such cell in order of tiles
  std::int64_t max_x = -1, max_y = -1;    ///< its column and row
  /// Smallest |error| that at least 50, 90 (LE90), 95, 99 % of the compared cells do not exceed, rounded down to 11 bits
  /// behind the first (less than 0.05 %).
  double p50_m = 0, p90_m = 0, p95_m = 0, p99_m = 0;
  double peak_m = 0;   ///< highest minus lowest valid cell of the reference inside the border
  double psnr_db = 0;  ///< 20 log10(peak / RMSE); +infinity for identical heights

  std::int64_t slope_cells = 0;     ///< compared cells whose eight neighbours are compared cells of the raster too
  double slope_rmse_deg = 0;
  std::int64_t aspect_cells = 0;    ///< those of them that slope by 2 degrees or more in both
  double aspect_rmse_deg = 0;       ///< of differences wrapped to [-180, 180]

  std::optional<double> consistency_m;  ///< RMSE between the factor x factor area averages of both
  std::int64_t consistency_blocks = 0;  ///< blocks that consist of compared cells only

  double integral_reference = 0, integral_result = 0;  ///< hypsometric integral, (mean - min) / (max - min); NaN when flat
  double wasserstein_m = 0;  ///< 1-Wasserstein distance between the heights, to 1/32768 of their common range
};

/// Compares two rasters of the same size. Reads each twice, by tiles of about 512 x 512 cells: memory does not grow with the
/// raster. Horn slopes (slope.h). Sums in double and in the fixed order of the tiles. Throws Error{input} when the sizes differ.
Comparison compare_terrain(const RasterSource& reference, const RasterSource& result, const CompareOptions& options,
                           Progress& progress);
Comparison compare_terrain(RasterView<const float> reference, RasterView<const float> result, const CompareOptions& options);

}  // namespace arete
