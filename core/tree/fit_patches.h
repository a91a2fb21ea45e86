#pragma once

#include "core/tree/compress.h"
#include "core/tree/tree_draft.h"

namespace arete {

/// A tree of the paper's profile: a dictionary learned on the raster, or given, and s coefficients a disc.
/// Throws as encode_patches, Error{memory} where the raster does not fit.
FittedTree fit_patches(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress);

}  // namespace arete
