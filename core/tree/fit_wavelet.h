#pragma once

#include <optional>
#include <vector>

#include "core/tree/compress.h"
#include "core/tree/tree_cells.h"

namespace arete {

/// A tree's file and what it was measured to reach.
struct FittedTree {
  std::vector<std::byte> file;  ///< empty where the target cannot be reached
  TreeErrors errors;
  TreeCoder coder = TreeCoder::wavelet;
  std::optional<ValueRatio> value_ratio;
};

/// A tree of the wavelet coder for a PSNR, an RMSE or a size: the quantiser's step is searched, each try measured on its
/// decoded file, until the error is 0.3 % below what is allowed, or the size 1 %. Two to six tries.
FittedTree fit_wavelet(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress);

}  // namespace arete
