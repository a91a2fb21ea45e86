#pragma once

#include "core/amplify/coded_patches.h"
#include "core/amplify/stage.h"
#include "core/sparse/dictionary.h"

namespace arete {

/// Fills the exemplar and atom bands that are wanted: each pitch block of cells takes the first atom of the patch whose centre is nearest
/// (of equals the first in row order). `coarse` is the window itself; void cells become void.
void map_sources(const CodedPatches& coded, const PatchGrid& grid, const std::vector<AtomSource>& sources, int factor,
                 const Window& window, RasterView<const float> coarse, const AmplifiedBands& out);

}  // namespace arete
