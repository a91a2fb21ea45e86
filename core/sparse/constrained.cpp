// É. Guérin, J. Digne, É. Galin, A. Peytavie, "Sparse representation of terrains for procedural modeling", Eurographics 2016.
#include "core/sparse/constrained.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>

#include "core/sparse/learning_steps.h"
#include "core/sparse/nearest_patches.h"
#include "core/support/error.h"
#include "core/support/parallel.h"

namespace arete {

namespace {

constexpr double least_gain = 1e-4;  // of the objective, for another iteration
constexpr int leading_rounds = 10;   // of power iteration: candidates only need its neighbourhood

// What the update needs to find a substitute, made once.
struct Candidates {
  Eigen::MatrixXf units;                  // the patches, normalised
  std::optional<NearestPatches> nearest;  // where the search is not exhaustive
  std::vector<char> taken;                // patches that are atoms
};

Eigen::MatrixXf scatter_of(const Eigen::MatrixXf& E) {
  Eigen::MatrixXf scatter(E.rows(), E.rows());
  scatter.noalias() = E * E.transpose();
  return scatter;
}

// |E^T f|^2 = f^T (E E^T) f, in a fixed order.
float gain_of(const Eigen::MatrixXf& scatter, const Eigen::Ref<const Eigen::VectorXf>& f) { return f.dot(scatter * f); }

std::vector<std::int64_t> patches_to_weigh(const Candidates& candidates, const Eigen::MatrixXf& E,
                                           const Eigen::Ref<const Eigen::VectorXf>& atom, int count) {
  std::vector<std::int64_t> patches;
  if (!candidates.nearest) {
    patches.resize(candidates.taken.size());
    std::iota(patches.begin(), patches.end(), std::int64_t{0});
    return patches;
  }
  const Eigen::VectorXf direction = leading_direction(E, atom, leading_rounds);
  patches = candidates.nearest->find(direction, count);
  const auto opposite = candidates.nearest->find(-direction, count);
  patches.insert(patches.end(), opposite.begin(), opposite.end());
  std::sort(patches.begin(), patches.end());
  return patches;
}

// The free patch of the largest gain above that of the atom now; -1 where there is none.
std::int64_t best_substitute(const Candidates& candidates, const Eigen::MatrixXf& E, const Eigen::Ref<const Eigen::VectorXf>& atom,
                             const ConstrainedOptions& options) {
  const Eigen::MatrixXf scatter = scatter_of(E);
  const std::vector<std::int64_t> patches = patches_to_weigh(candidates, E, atom, options.candidates);
  std::vector<float> gains(patches.size());
  constexpr std::int64_t piece = 512;
  const auto count = static_cast<std::int64_t>(patches.size());
  parallel_for((count + piece - 1) / piece, options.threads, [&](std::int64_t p) {
    for (std::int64_t i = p * piece; i < std::min(count, (p + 1) * piece); ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (!candidates.taken[static_cast<std::size_t>(patches[index])])
        gains[index] = gain_of(scatter, candidates.units.col(patches[index]));
    }
  });
  const auto best = std::max_element(gains.begin(), gains.end());
  constexpr float clearly = 1 + 1e-5f;  // more than float sums could feign
  if (best == gains.end() || *best <= clearly * gain_of(scatter, atom)) return -1;
  return patches[static_cast<std::size_t>(best - gains.begin())];
}

void take(Candidates& candidates, ConstrainedResult& result, Eigen::Index j, std::int64_t patch) {
  const auto index = static_cast<std::size_t>(j);
  candidates.taken[static_cast<std::size_t>(result.patches[index])] = 0;
  candidates.taken[static_cast<std::size_t>(patch)] = 1;
  result.patches[index] = patch;
  result.D.col(j) = candidates.units.col(patch);
}

std::int64_t worst_free_patch(const Candidates& candidates, const Eigen::MatrixXf& R) {
  std::int64_t worst = -1;
  float most = 0;
  for (std::int64_t i = 0; i < R.cols(); ++i) {
    if (candidates.taken[static_cast<std::size_t>(i)]) continue;
    const float left = R.col(i).squaredNorm();
    if (left > most) {
      most = left;
      worst = i;
    }
  }
  return worst;
}

void update_atoms(const Eigen::MatrixXf& F, const ConstrainedOptions& options, Candidates& candidates, ConstrainedResult& result) {
  Eigen::MatrixXf R = F - decode(result.D, result.X);
  const auto uses = uses_of_atoms(result.X, result.D.cols());
  for (Eigen::Index j = 0; j < result.D.cols(); ++j) {
    const std::vector<Use>& used = uses[static_cast<std::size_t>(j)];
    if (used.empty()) {
      const std::int64_t worst = worst_free_patch(candidates, R);
      if (worst >= 0) take(candidates, result, j, worst);
      continue;
    }
    const Eigen::MatrixXf E = errors_without(R, result.D.col(j), used, result.X);
    const std::int64_t substitute = best_substitute(candidates, E, result.D.col(j), options);
    if (substitute >= 0) take(candidates, result, j, substitute);
    place_atom(result.D.col(j), E, used, result.X, R);
  }
}

}  // namespace

ConstrainedResult learn_constrained(const Eigen::MatrixXf& F, const ConstrainedOptions& options, Progress& progress) {
  if (F.cols() < options.atoms)
    throw Error(ErrorKind::input, "learning " + std::to_string(options.atoms) + " atoms needs as many patches, found " +
                                      std::to_string(F.cols()) + ": give more terrain, a smaller radius or fewer atoms");
  Candidates candidates{F.colwise().normalized(), {}, std::vector<char>(static_cast<std::size_t>(F.cols()))};
  if (!options.exhaustive) candidates.nearest.emplace(candidates.units);
  ConstrainedResult result;
  result.patches = choose_columns(F.cols(), options.atoms, options.seed);
  result.D.resize(F.rows(), options.atoms);
  for (Eigen::Index j = 0; j < result.D.cols(); ++j) take(candidates, result, j, result.patches[static_cast<std::size_t>(j)]);

  progress.begin("constrained learning", options.iterations);
  result.objective.push_back(improve_codes(F, result.D, options.sparsity, options.threads, result.X).sum());
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    ConstrainedResult next = result;
    update_atoms(F, options, candidates, next);
    const double before = result.objective.back();
    const double objective = improve_codes(F, next.D, options.sparsity, options.threads, next.X).sum();
    progress.advance(1);
    if (objective > before) break;  // all that is left is rounding
    result = std::move(next);
    result.objective.push_back(objective);
    if (before - objective < least_gain * before) break;
  }
  progress.end();
  return result;
}

}  // namespace arete
