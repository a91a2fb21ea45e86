#pragma once

#include <memory>

#include "core/amplify/stage.h"
#include "core/sparse/dictionary.h"

namespace arete {

/// The published amplification (Guérin et al. 2016, section "Amplification"; D9 of the habilitation thesis): each patch is its mean plus a
/// sparse sum of atoms found over the low-resolution half of the dictionary; the same coefficients over the high-resolution half, blended by the
/// disc weights, give the finer terrain. The mean is that of the square, and inner products are weighted by the disc,
/// as in the authors' program. Beyond its border the terrain repeats its edge; into voids it is continued (extend_into_voids).
/// The coarse shape is rebuilt from the exemplar: the result is NOT consistent with the input. No uncertainty band.
struct PaperOptions {
  int sparsity = 1;
  int pitch = 0;  ///< coarse cells between patches, a divisor of the patch; 0: half a patch
  int threads = 0;
};

/// Throws Error{input} where the dictionary has no high-resolution half.
std::unique_ptr<Stage> make_paper_stage(Dictionary dictionary, const PaperOptions& options);

}  // namespace arete
