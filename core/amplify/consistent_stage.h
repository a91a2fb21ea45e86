#pragma once

#include <memory>

#include "core/amplify/stage.h"
#include "core/sparse/dictionary.h"

namespace arete {

/// Consistent amplification: z' = U(z - D e) + e, where U is the dictionary's linear upsampler, D the area average, and e the detail: each
/// patch's sparse code selects atoms, whose detail is scaled to the variance that the patch's activity foretells, and
/// blended so that overlapping keeps the variance. D z' = z to the rounding of one float; a plane stays a plane; without
/// detail this is the least-squares upsampling.
///
/// Beyond the border and into voids the terrain is continued by planes; void cells stay void and lend no detail. Flat
/// water (find_flat_water) stays flat to the last bit, and a cell on its shore does not dip below it.
struct ConsistentOptions {
  double detail = 1;  ///< amplitude of the detail: 0 least error ... 1 natural
  int sparsity = 1;
  int pitch = 0;  ///< coarse cells between patches, a divisor of the patch; 0: half a patch
  int threads = 0;
};

/// Throws Error{input} where the dictionary has no upsampler, or detail is wanted and it has none.
std::unique_ptr<Stage> make_consistent_stage(Dictionary dictionary, const ConsistentOptions& options);

}  // namespace arete
