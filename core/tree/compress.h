#pragma once

#include <cstdint>
#include <optional>

#include "core/codec/patch_coder.h"
#include "core/codec/tree_file.h"
#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "core/tree/measure.h"

namespace arete {

/// What a tree is to reach. Errors are of elevations, in metres.
struct CompressionTarget {
  TreeClaim kind = TreeClaim::psnr;
  /// psnr: dB, > 0. rmse, max_error: metres, > 0. bytes: of the whole file. lossless: not used.
  double value = 60;
};

/// How a tree is filled.
enum class TreeProfile {
  best,   ///< the smallest file: wavelet or predictive, as the target asks
  paper,  ///< the published model, a dictionary learned on the raster, or given; `target` is not used
};

/// Whether dead-flat water (find_flat_water) comes back exactly from a lossy tree.
enum class FlatWater {
  automatic,  ///< where that makes the tree smaller at the same error
  exact,
  as_others,
};

struct CompressOptions {
  TreeProfile profile = TreeProfile::best;
  PatchCodingOptions patches;  ///< of the paper's profile; its threads and node side are set from those below
  CompressionTarget target;
  FlatWater flat = FlatWater::automatic;  ///< of the wavelet coder; the predictive one keeps flat cells flat anyway, within its bound
  int node_side = 0;  ///< 0: 512 where the tree is below a quarter of a bit a cell and that is smaller, else 256; 256 beyond 4096 x 4096 cells
  int passes = 2;     ///< of the quantiser: 1 takes half the time and loses 0.03 to 0.05 dB
  int threads = 0;
  Scratch scratch;    ///< for all that the encoder keeps; the result does not depend on it
};

struct CompressionReport {
  TreeErrors errors;  ///< measured on the decoded tree
  TreeCoder coder = TreeCoder::wavelet;
  std::optional<ValueRatio> value_ratio;  ///< of the paper's profile
};

/// Encodes a raster as a tree, the bytes of the file going to `sink`. `header` says everything that the source knows of itself
/// (type, scale, offset, georeference, texts); the rest of it is filled in. The raster is read by window, several times where it does
/// not fit into the memory; up to 2 bytes a cell without voids, 8 with, and the file go to the scratch folder then (the paper's profile needs memory). Errors
/// are measured as elevations of the stored type, as read_stored gives them back.
/// Throws Error{input} where all cells are void, Error{usage} where the target cannot be reached (a size below that of an
/// empty tree, a quality beyond what single precision holds), Error{interrupted} where `progress` says so.
CompressionReport compress(const StoredSource& source, TreeHeader header, const CompressOptions& options, const TreeWriter::Sink& sink,
                           Progress* progress = nullptr);

}  // namespace arete
