#pragma once

#include "core/amplify/detail.h"
#include "tests/core/amplify/sample_terrain.h"

namespace arete {

/// A dictionary for consistent amplification, learned from one fractal exemplar of 96 x 96 coarse cells: every third patch, the
/// upsampler, and the detail.
inline Dictionary fractal_dictionary(int factor, std::uint64_t seed = 1, double beta = 2, int patch_cells = 8) {
  const Raster<float> exemplar = fractal_terrain(96 * factor, 96 * factor, seed, beta);
  Dictionary dictionary = pair_dictionary(exemplar.view(), factor, make_patch_grid(patch_cells), PatchEdges::inside, 3);
  NoProgress silent;
  add_detail(dictionary, {exemplar.view()}, 2, silent);
  return dictionary;
}

}  // namespace arete
