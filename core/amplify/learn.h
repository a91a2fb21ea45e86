#pragma once

#include <string>
#include <vector>

#include "core/sparse/dictionary.h"
#include "core/support/progress.h"
#include "core/terrain/raster.h"

namespace arete {

/// A terrain to learn from, in metres, NaN where void.
struct Exemplar {
  std::string name;
  RasterView<const float> cells;
  double cell_size_m = 0;  ///< 0: unknown
};

struct LearnOptions {
  LearningMethod method = LearningMethod::constrained;
  int factor = 4;          ///< f >= 2: the coarse half is the f x f area average
  int patch_cells = 6;     ///< m, coarse cells, even, at least 4: radius m / 2
  int atoms = 1024;        ///< N; fewer where the exemplars hold fewer patches. For `all`: 0 takes every patch
  int sparsity = 1;        ///< atoms per patch while learning
  bool symmetries = false; ///< also the 7 other rotations and mirrors of each patch
  bool detail = true;      ///< also the upsampler and the detail, for consistent amplification
  bool exhaustive = false; ///< constrained: weigh every patch as a substitute, without FLANN
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Patches that K-SVD and constrained learning train on, drawn evenly from the exemplars. Four times as many lower the objective on
/// patches left out by less than 1 %.
inline constexpr std::int64_t most_training_patches = 32'768;

struct LearnReport {
  std::int64_t patches = 0;       ///< found in the exemplars, flat ones and those with voids left out
  std::int64_t trained = 0;       ///< used
  std::vector<double> objective;  ///< ||F - D X||^2 per iteration; empty for `all`
};

/// Learns the pair (H, L) of a factor: patches of the exemplars' area averages give the low half, by one of three methods: every patch;
/// K-SVD; constrained (every atom a real patch). The high half is the same ground in the exemplar, divided by the norm of the low patch. For
/// K-SVD, whose atoms are no ground, it is the least-squares answer to the high patches for the same codes (Zeyde, Elad & Protter
/// 2010). The same input, options and seed give the same dictionary for any number of threads.
/// `all` takes the half-overlapping patches of the grid on which amplification works, those that the border cuts included, so that an
/// exemplar's own average gives back the exemplar.
/// Throws Error{input} where the exemplars hold no usable patch, Error{usage} for options out of range.
Dictionary learn_dictionary(const std::vector<Exemplar>& exemplars, const LearnOptions& options, LearnReport& report, Progress& progress);

}  // namespace arete
