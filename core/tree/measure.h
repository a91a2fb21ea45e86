#pragma once

#include <cstdint>

#include "core/support/progress.h"
#include "core/tree/elevation_tree.h"

namespace arete {

/// Stored numbers of a DEM by window: NaN where void. Safe to call from several threads.
class StoredSource {
 public:
  virtual ~StoredSource() = default;
  virtual Size size() const = 0;
  virtual void read_stored(const Window& window, RasterView<double> out) const = 0;
};

/// A tree against its original, over the cells that are not void.
struct TreeErrors {
  std::uint64_t bytes = 0;        ///< of the tree
  std::int64_t cells = 0;
  std::int64_t valid_cells = 0;   ///< of the original
  std::int64_t void_differs = 0;  ///< cells that are void in one of the two only
  std::int64_t differs = 0;       ///< valid cells whose stored numbers are not the same bits
  double lowest_m = 0;            ///< of the original's valid cells
  double highest_m = 0;
  double rmse_m = 0;
  double max_error_m = 0;
  /// 20 log10((highest - lowest) / RMSE); infinite without error.
  double psnr_db() const;
  double bits_per_sample() const { return 8 * static_cast<double>(bytes) / static_cast<double>(cells); }
};

/// Decodes the tree by windows, in the type of its header, and compares it with `original`, which has its size: as a DEM holds it
/// that has the header's nodata value, in which a valid cell that is decoded to that value has the next one (next_value). Sums are of
/// doubles in an order that does not depend on the memory.
TreeErrors measure_tree(const ElevationTree& tree, const StoredSource& original, std::int64_t memory_bytes, Progress* progress = nullptr);

/// How far such a cell is moved, in stored units; 0 where the type has no such value.
double nodata_step(const TreeHeader& header);

/// Whether the tree is what its header says. Errors within a relative 1e-9 of a claimed RMSE or PSNR count as kept.
bool keeps_claim(const TreeHeader& header, const TreeErrors& errors);

}  // namespace arete
