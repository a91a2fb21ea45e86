#pragma once

#include <Eigen/Core>

namespace arete {

/// `count` orthonormal directions near those that hold most energy of the columns of F (K x n), as rows (count x K), by subspace iteration
/// on at most 4096 columns evenly spaced. Rows beyond K are zero. Orthonormal to rounding whatever the data; how near to the
/// principal directions they are is not promised.
Eigen::MatrixXd main_directions(const Eigen::Ref<const Eigen::MatrixXf>& F, Eigen::Index count);

}  // namespace arete
