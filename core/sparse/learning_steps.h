#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sparse/omp.h"

namespace arete {

// The parts that K-SVD and constrained learning share. F is K x n training patches, D K x N unit columns, X the codes of F.

/// `count` different columns of F, chosen by the hash of `seed`, in ascending order; all of them where F has no more.
std::vector<std::int64_t> choose_columns(std::int64_t columns, std::int64_t count, std::uint64_t seed);

/// Codes F anew with D; a patch keeps its old code where the new one is not better. Returns the new squared residuals.
/// `X` may be empty: then every patch takes its new code.
Eigen::VectorXd improve_codes(const Eigen::MatrixXf& F, const Eigen::MatrixXf& D, int sparsity, int threads, SparseCodes& X);

/// Where an atom is used: coefficient X.coefficients(slot, patch).
struct Use {
  std::int64_t patch = 0;
  std::int64_t slot = 0;
};
/// The uses of each atom, patches ascending.
std::vector<std::vector<Use>> uses_of_atoms(const SparseCodes& X, std::int64_t atoms);

/// E_j: what is left of the patches that use atom j when it is taken away (K x |uses|), from the residuals R = F - D X.
Eigen::MatrixXf errors_without(const Eigen::MatrixXf& R, const Eigen::Ref<const Eigen::VectorXf>& atom, const std::vector<Use>& uses,
                               const SparseCodes& X);

/// Gives atom j the direction `atom` (unit): its coefficients become E_j^T atom, their best values, and R what is left then.
void place_atom(const Eigen::Ref<const Eigen::VectorXf>& atom, const Eigen::MatrixXf& E, const std::vector<Use>& uses, SparseCodes& X,
                Eigen::MatrixXf& R);

/// The unit vector u that maximises |E^T u|, the leading singular vector, by power iteration from `start`: |E^T u| never falls below
/// |E^T start|. One round is the approximate update of Rubinstein et al. 2008. Returns `start` where E is zero.
Eigen::VectorXf leading_direction(const Eigen::MatrixXf& E, const Eigen::Ref<const Eigen::VectorXf>& start, int rounds);

}  // namespace arete
