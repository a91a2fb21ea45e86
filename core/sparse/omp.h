#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/sparse/atom_search.h"
#include "core/sparse/correlate.h"

namespace arete {

/// Which atoms each signal is a sum of: signal i = sum over t of coefficients(t, i) atom atoms(t, i). Each column has the order of
/// selection; a signal that needed fewer atoms ends with atom -1 and coefficient 0.
struct SparseCodes {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic> atoms;  ///< s x n
  Eigen::MatrixXf coefficients;                                       ///< s x n
  std::int64_t sparsity() const { return atoms.rows(); }
  std::int64_t count() const { return atoms.cols(); }
};

/// A dictionary made ready for coding.
struct CodingDictionary {
  PackedAtoms atoms;                 ///< empty where the search is enough
  Eigen::MatrixXf gram;              ///< padded N x N, for sparsity > 1 and N <= most_gram_atoms
  std::optional<AtomSearch> search;  ///< for N >= least_search_atoms without a Gram matrix: the same answers, sooner
};

/// Atoms from which the tree search is faster than the plain product on terrain.
inline constexpr std::int64_t least_search_atoms = 2048;

/// Atoms above which OMP with s > 1 works on residuals instead of a Gram matrix (64 MiB at 4096).
inline constexpr std::int64_t most_gram_atoms = 4096;

/// Prepares the unit columns of D (K x N) for codes of `sparsity` atoms.
CodingDictionary prepare_coding(const Eigen::Ref<const Eigen::MatrixXf>& D, int sparsity, int threads = 0);

/// How the atoms of a code are selected, as metadata names it.
inline constexpr const char* omp_selection = "OMP: largest absolute correlation with the residual, then refit";

/// Orthogonal matching pursuit: at most `sparsity` atoms per column of F (K x n), chosen one by one by the largest |<residual, d>| (of
/// equals the lowest index), all coefficients refitted after each choice. Batch-OMP with a progressive Cholesky factor in double
/// (Rubinstein, Zibulevsky & Elad 2008). A signal stops early where the strongest correlation left is below 2e-6 of its first (float
/// rounding), or the next atom depends linearly on those chosen (squared distance to their span below 1e-6).
/// The code of a signal does not depend on the others or on `threads`. `sparsity` must not exceed 1 where the dictionary was prepared for 1.
/// Cost per signal: K N + N s^2 / 2 multiply-adds; without Gram matrix s K N.
SparseCodes omp(const CodingDictionary& dictionary, const Eigen::Ref<const Eigen::MatrixXf>& F, int sparsity, int threads = 0);

/// D X: the signals that the codes stand for, K x n.
Eigen::MatrixXf decode(const Eigen::Ref<const Eigen::MatrixXf>& D, const SparseCodes& X);

/// Squared residual norm of each signal, ||F_i - D X_i||^2, in double.
Eigen::VectorXd squared_residuals(const Eigen::Ref<const Eigen::MatrixXf>& F, const Eigen::Ref<const Eigen::MatrixXf>& D,
                                  const SparseCodes& X, int threads = 0);

}  // namespace arete
