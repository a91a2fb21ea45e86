#pragma once

#include "core/tree/compress.h"
#include "core/tree/tree_draft.h"

namespace arete {

/// A tree of the wavelet coder for a PSNR, an RMSE or a size: the quantiser's step is searched until the error, measured on the
/// decoded file, is at most 0.3 % below what is allowed, or the size 1 %. The first step comes from the sizes of the details,
/// so that two or three tries are enough, most of the time.
FittedTree fit_wavelet(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress);

}  // namespace arete
