// M. Aharon, M. Elad, A. Bruckstein, "K-SVD: an algorithm for designing overcomplete dictionaries for sparse representation", IEEE
// Trans. Signal Processing 2006; the approximate update is that of R. Rubinstein, M. Zibulevsky, M. Elad, Technion CS-2008-08.
#include "core/sparse/ksvd.h"

#include <algorithm>
#include <string>

#include "core/sparse/learning_steps.h"
#include "core/support/error.h"

namespace arete {

namespace {

constexpr double least_gain = 1e-4;  // of the objective, for another iteration
constexpr int exact_rounds = 200;

Eigen::MatrixXf initial_atoms(const Eigen::MatrixXf& F, int atoms, std::uint64_t seed) {
  Eigen::MatrixXf D(F.rows(), atoms);
  Eigen::Index j = 0;
  for (const std::int64_t column : choose_columns(F.cols(), atoms, seed)) D.col(j++) = F.col(column).normalized();
  return D;
}

// Updates every atom in turn; those without use take the worst represented patches, worst first.
void update_atoms(const Eigen::MatrixXf& F, int rounds, Eigen::MatrixXf& D, SparseCodes& X) {
  Eigen::MatrixXf R = F - decode(D, X);
  const auto uses = uses_of_atoms(X, D.cols());
  Eigen::VectorXf left = R.colwise().squaredNorm();
  for (Eigen::Index j = 0; j < D.cols(); ++j) {
    const std::vector<Use>& used = uses[static_cast<std::size_t>(j)];
    if (used.empty()) {
      Eigen::Index worst;
      left.maxCoeff(&worst);
      left[worst] = 0;  // one atom per patch
      D.col(j) = F.col(worst).normalized();
      continue;
    }
    const Eigen::MatrixXf E = errors_without(R, D.col(j), used, X);
    const Eigen::VectorXf atom = leading_direction(E, D.col(j), rounds);
    D.col(j) = atom;
    place_atom(atom, E, used, X, R);
  }
}

}  // namespace

KsvdResult learn_ksvd(const Eigen::MatrixXf& F, const KsvdOptions& options, Progress& progress) {
  if (F.cols() < options.atoms)
    throw Error(ErrorKind::input, "learning " + std::to_string(options.atoms) + " atoms needs as many patches, found " +
                                      std::to_string(F.cols()) + ": give more terrain, a smaller radius or fewer atoms");
  KsvdResult result{initial_atoms(F, options.atoms, options.seed), {}, {}};
  progress.begin("K-SVD", options.iterations);
  result.objective.push_back(improve_codes(F, result.D, options.sparsity, options.threads, result.X).sum());
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    KsvdResult next{result.D, result.X, {}};
    update_atoms(F, options.exact_update ? exact_rounds : 1, next.D, next.X);
    const double objective = improve_codes(F, next.D, options.sparsity, options.threads, next.X).sum();
    const double before = result.objective.back();
    progress.advance(1);
    if (objective > before) break;  // all that is left is rounding
    result.D = std::move(next.D);
    result.X = std::move(next.X);
    result.objective.push_back(objective);
    if (before - objective < least_gain * before) break;
  }
  progress.end();
  return result;
}

}  // namespace arete
