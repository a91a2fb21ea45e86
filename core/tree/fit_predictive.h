#pragma once

#include "core/tree/compress.h"
#include "core/tree/tree_draft.h"

namespace arete {

/// A tree of the predictive coder: lossless, or with no cell further off than the target. Proven by decoding the file.
/// Throws Error{input} where whole numbers span more than 31 bits, or the bound is below what their type resolves.
FittedTree fit_predictive(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress);

}  // namespace arete
