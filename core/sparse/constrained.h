#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sparse/omp.h"
#include "core/support/progress.h"

namespace arete {

struct ConstrainedOptions {
  int atoms = 256;
  int sparsity = 1;
  int iterations = 10;           ///< at most; ends sooner when an iteration gains less than 1e-4 of the objective
  bool exhaustive = false;       ///< weigh every patch as a substitute, not only the nearest ones
  int candidates = 32;           ///< nearest patches to weigh, on either side of the leading singular vector
  std::uint64_t seed = 1;
  int threads = 0;
};

struct ConstrainedResult {
  Eigen::MatrixXf D;                  ///< K x N: column j is column `patches[j]` of F divided by its norm, bit for bit
  std::vector<std::int64_t> patches;  ///< N, all different
  SparseCodes X;
  std::vector<double> objective;      ///< as in KsvdResult: never rises
};

/// Constrained learning (Guérin et al. 2016, problem 2): as K-SVD, but every atom is a patch. The update replaces atom j by the patch f (unit)
/// that maximises |E_j^T f|, which leaves ||E_j||^2 - |E_j^T f|^2, where that is less than now. Candidates are those
/// nearest to the leading singular vector of E_j and to its negative (NearestPatches), ranked by their true gain; `exhaustive`
/// ranks all patches. An atom that nothing uses becomes the worst represented patch. Same seed, same bytes.
/// Throws Error{input} where F has fewer than N columns. Columns of F must not be zero.
ConstrainedResult learn_constrained(const Eigen::MatrixXf& F, const ConstrainedOptions& options, Progress& progress);

}  // namespace arete
