#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sparse/omp.h"
#include "core/support/progress.h"

namespace arete {

struct KsvdOptions {
  int atoms = 128;
  int sparsity = 1;
  int iterations = 15;         ///< at most; ends sooner when an iteration gains less than 1e-4 of the objective
  bool exact_update = false;   ///< leading singular vector to float precision, instead of one power iteration
  std::uint64_t seed = 1;
  int threads = 0;
};

struct KsvdResult {
  Eigen::MatrixXf D;               ///< K x N unit columns
  SparseCodes X;                   ///< of F, for this D
  std::vector<double> objective;   ///< ||F - D X||^2 after the first coding and after each iteration: never rises
};

/// K-SVD (Aharon, Elad & Bruckstein 2006): min ||F - D X||_F^2 with at most `sparsity` atoms per column of F (K x n). Starts from N
/// different columns of F; alternates OMP (a patch keeps its code where the new one is worse) and the update of each atom with its
/// coefficients by the leading singular vector of the error without it. An atom that nothing uses becomes the worst
/// represented patch. The same seed gives the same bytes for any number of threads.
/// Throws Error{input} where F has fewer than N columns. Columns of F must not be zero.
/// Cost per iteration: n (K N + N s^2) for the codes, about 4 K n s for the update (some tens of times that when exact).
KsvdResult learn_ksvd(const Eigen::MatrixXf& F, const KsvdOptions& options, Progress& progress);

}  // namespace arete
