#pragma once

#include <cstdint>
#include <optional>

#include "core/codec/tree_file.h"
#include "core/support/progress.h"
#include "core/terrain/raster.h"

namespace arete {

/// Stored numbers of a DEM by window: NaN where void.
class StoredSource {
 public:
  virtual ~StoredSource() = default;
  virtual Size size() const = 0;
  virtual void read_stored(const Window& window, RasterView<double> out) const = 0;
};

/// What a tree is to reach. Errors are of elevations, in metres.
struct CompressionTarget {
  TreeClaim kind = TreeClaim::psnr;
  /// psnr: dB, > 0. rmse, max_error: metres, > 0. bytes: of the whole file. lossless: not used.
  double value = 60;
};

struct CompressOptions {
  CompressionTarget target;
  int node_side = 0;  ///< 0: 512 where the tree is below a quarter of a bit a cell, else 256
  int passes = 2;     ///< of the quantiser: 1 takes half the time and loses 0.03 to 0.05 dB
  int threads = 0;
};

/// What was reached, measured on the decoded tree over the cells that are not void.
struct CompressionReport {
  std::uint64_t bytes = 0;
  std::int64_t cells = 0;
  std::int64_t valid_cells = 0;
  double lowest_m = 0;   ///< of the original's valid cells
  double highest_m = 0;
  double rmse_m = 0;
  double max_error_m = 0;
  /// 20 log10((highest - lowest) / RMSE); infinite without error.
  double psnr_db() const;
  double bits_per_sample() const { return 8 * static_cast<double>(bytes) / static_cast<double>(cells); }
};

/// Encodes a raster as a tree, the bytes of the file going to `sink`. `header` says everything that the source knows of itself
/// (type, scale, offset, georeference, texts); the rest of it is filled in. The whole raster is held in memory, about 24 bytes
/// a cell. Errors are measured as elevations of the stored type, as read_stored gives them back.
/// Throws Error{input} where all cells are void, Error{usage} where the target cannot be reached (a size below that of an
/// empty tree, a quality beyond what single precision holds), Error{interrupted} where `progress` says so.
CompressionReport compress(const StoredSource& source, TreeHeader header, const CompressOptions& options, const TreeWriter::Sink& sink,
                           Progress* progress = nullptr);

}  // namespace arete
