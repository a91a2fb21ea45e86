#include "core/sparse/learning_steps.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/support/parallel.h"
#include "core/support/random.h"

namespace arete {

std::vector<std::int64_t> choose_columns(std::int64_t columns, std::int64_t count, std::uint64_t seed) {
  std::vector<std::int64_t> chosen(static_cast<std::size_t>(columns));
  std::iota(chosen.begin(), chosen.end(), std::int64_t{0});
  if (count >= columns) return chosen;
  const auto rank = [&](std::int64_t i) { return std::pair(hash_position(seed, static_cast<std::uint64_t>(i)), i); };
  std::nth_element(chosen.begin(), chosen.begin() + count, chosen.end(),
                   [&](std::int64_t a, std::int64_t b) { return rank(a) < rank(b); });
  chosen.resize(static_cast<std::size_t>(count));
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

Eigen::VectorXd improve_codes(const Eigen::MatrixXf& F, const Eigen::MatrixXf& D, int sparsity, int threads, SparseCodes& X) {
  SparseCodes next = omp(prepare_coding(D, sparsity, threads), F, sparsity, threads);
  Eigen::VectorXd squares = squared_residuals(F, D, next, threads);
  if (X.count() == F.cols()) {
    const Eigen::VectorXd old = squared_residuals(F, D, X, threads);
    for (std::int64_t i = 0; i < F.cols(); ++i) {
      if (squares[i] < old[i]) continue;
      next.atoms.col(i) = X.atoms.col(i);
      next.coefficients.col(i) = X.coefficients.col(i);
      squares[i] = old[i];
    }
  }
  X = std::move(next);
  return squares;
}

std::vector<std::vector<Use>> uses_of_atoms(const SparseCodes& X, std::int64_t atoms) {
  std::vector<std::vector<Use>> uses(static_cast<std::size_t>(atoms));
  for (std::int64_t i = 0; i < X.count(); ++i)
    for (std::int64_t t = 0; t < X.sparsity(); ++t)
      if (X.atoms(t, i) >= 0) uses[static_cast<std::size_t>(X.atoms(t, i))].push_back({i, t});
  return uses;
}

Eigen::MatrixXf errors_without(const Eigen::MatrixXf& R, const Eigen::Ref<const Eigen::VectorXf>& atom, const std::vector<Use>& uses,
                               const SparseCodes& X) {
  Eigen::MatrixXf E(R.rows(), static_cast<Eigen::Index>(uses.size()));
  for (std::size_t u = 0; u < uses.size(); ++u)
    E.col(static_cast<Eigen::Index>(u)) = R.col(uses[u].patch) + X.coefficients(uses[u].slot, uses[u].patch) * atom;
  return E;
}

void place_atom(const Eigen::Ref<const Eigen::VectorXf>& atom, const Eigen::MatrixXf& E, const std::vector<Use>& uses, SparseCodes& X,
                Eigen::MatrixXf& R) {
  for (std::size_t u = 0; u < uses.size(); ++u) {
    const auto column = static_cast<Eigen::Index>(u);
    const float coefficient = E.col(column).dot(atom);
    X.coefficients(uses[u].slot, uses[u].patch) = coefficient;
    R.col(uses[u].patch) = E.col(column) - coefficient * atom;
  }
}

Eigen::VectorXf leading_direction(const Eigen::MatrixXf& E, const Eigen::Ref<const Eigen::VectorXf>& start, int rounds) {
  constexpr double enough = 1e-7;  // change of direction at which float has no more to say
  Eigen::VectorXf direction = start;
  for (int round = 0; round < rounds; ++round) {
    Eigen::VectorXd turned = Eigen::VectorXd::Zero(E.rows());
    for (Eigen::Index u = 0; u < E.cols(); ++u)
      turned += (static_cast<double>(E.col(u).dot(direction)) * E.col(u).cast<double>());
    const double norm = turned.norm();
    if (!(norm > 0)) break;
    const Eigen::VectorXf next = (turned / norm).cast<float>();
    const double change = (next - direction).norm();
    direction = next;
    if (change < enough) break;
  }
  return direction;
}

}  // namespace arete
