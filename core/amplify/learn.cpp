#include "core/amplify/learn.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Dense>

#include "core/amplify/detail.h"
#include "core/sparse/constrained.h"
#include "core/sparse/ksvd.h"
#include "core/sparse/learning_steps.h"
#include "core/sparse/patches.h"
#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

/// Coarse patches and where they come from.
struct Training {
  Eigen::MatrixXf patches;  // K x n
  std::vector<double> means;
  std::vector<AtomSource> sources;
  std::int64_t found = 0;
};

void check(const std::vector<Exemplar>& exemplars, const LearnOptions& options) {
  if (exemplars.empty()) throw Error(ErrorKind::usage, "learn: no exemplar given");
  if (options.factor < 2) throw Error(ErrorKind::usage, "learn: factor of " + std::to_string(options.factor) + ": expected at least 2");
  if (options.patch_cells < 4 || options.patch_cells % 2 != 0)
    throw Error(ErrorKind::usage, "learn: patch of " + std::to_string(options.patch_cells) + " cells: expected an even number, at least 4");
  if (options.sparsity < 1) throw Error(ErrorKind::usage, "learn: sparsity of " + std::to_string(options.sparsity) + ": expected at least 1");
  if (options.atoms < 0 || (options.atoms == 0 && options.method != LearningMethod::all))
    throw Error(ErrorKind::usage, "learn: " + std::to_string(options.atoms) + " atoms: expected at least 1");
}

bool takes_every_patch(const LearnOptions& options) { return options.method == LearningMethod::all && options.atoms == 0; }

Patches patches_of(RasterView<const float> coarse, const LearnOptions& options) {
  const bool complete = options.method == LearningMethod::all;
  // Learning sees every second place, more than amplification will use.
  const PatchGrid grid = make_patch_grid(options.patch_cells, complete ? 0 : 2);
  return extract_patches(coarse, grid, {complete ? PatchEdges::replicate : PatchEdges::inside, options.symmetries, true, options.threads});
}

/// How many patches of an exemplar train: an even share, all of them for the complete dictionary.
std::int64_t share_of(std::int64_t found, std::size_t exemplars, const LearnOptions& options) {
  if (takes_every_patch(options)) return found;
  const std::int64_t wanted = options.method == LearningMethod::all ? options.atoms : most_training_patches;
  return std::min(found, (wanted + static_cast<std::int64_t>(exemplars) - 1) / static_cast<std::int64_t>(exemplars));
}

Training gather(const std::vector<Exemplar>& exemplars, const LearnOptions& options) {
  Training training;
  std::vector<Patches> patches;
  std::vector<std::vector<std::int64_t>> chosen;
  std::int64_t count = 0;
  for (const Exemplar& exemplar : exemplars) {
    patches.push_back(patches_of(area_average(exemplar.cells, options.factor).view(), options));
    const std::int64_t found = patches.back().count();
    chosen.push_back(choose_columns(found, share_of(found, exemplars.size(), options), options.seed + chosen.size()));
    training.found += found;
    count += static_cast<std::int64_t>(chosen.back().size());
  }
  if (count == 0)
    throw Error(ErrorKind::input, "learn: the exemplars hold no patch of " + std::to_string(options.patch_cells * options.factor) +
                                      " x " + std::to_string(options.patch_cells * options.factor) +
                                      " cells with relief and without voids: give larger ones, or a smaller radius or factor");
  training.patches.resize(std::int64_t{options.patch_cells} * options.patch_cells, count);
  Eigen::Index to = 0;
  for (std::size_t e = 0; e < exemplars.size(); ++e)
    for (const std::int64_t i : chosen[e]) {
      const PatchOrigin& origin = patches[e].origins[static_cast<std::size_t>(i)];
      training.patches.col(to++) = patches[e].values.col(i);
      training.means.push_back(patches[e].means[static_cast<std::size_t>(i)]);
      training.sources.push_back({static_cast<std::int32_t>(e), origin.x, origin.y, origin.symmetry});
    }
  return training;
}

/// The fine ground of a coarse patch, minus the coarse mean.
void cut_high(const std::vector<Exemplar>& exemplars, const AtomSource& source, double mean, const LearnOptions& options,
              Eigen::Ref<Eigen::VectorXf> high) {
  cut_cells(exemplars[static_cast<std::size_t>(source.exemplar)].cells, source.x * options.factor, source.y * options.factor,
            options.patch_cells * options.factor, source.symmetry, high.data());
  for (float& z : high) z = static_cast<float>(static_cast<double>(z) - mean);
}

/// Atoms that are the training patches `chosen`: both halves divided by the norm of the low patch.
void take_real_atoms(const std::vector<Exemplar>& exemplars, const Training& training, const std::vector<std::int64_t>& chosen,
                     const LearnOptions& options, Dictionary& dictionary) {
  const int side = options.patch_cells * options.factor;
  const auto count = static_cast<Eigen::Index>(chosen.size());
  dictionary.low.resize(training.patches.rows(), count);
  dictionary.high.resize(Eigen::Index{side} * side, count);
  dictionary.sources.resize(chosen.size());
  parallel_for(count, options.threads, [&](std::int64_t j) {
    const std::int64_t patch = chosen[static_cast<std::size_t>(j)];
    const float norm = training.patches.col(patch).norm();
    dictionary.low.col(j) = training.patches.col(patch) / norm;
    dictionary.sources[static_cast<std::size_t>(j)] = training.sources[static_cast<std::size_t>(patch)];
    cut_high(exemplars, training.sources[static_cast<std::size_t>(patch)], training.means[static_cast<std::size_t>(patch)], options,
             dictionary.high.col(j));
    dictionary.high.col(j) /= norm;
  });
}

/// argmin ||H_patches - H X||_F: H = H_patches X^T (X X^T)^-1, with a ridge for atoms that nothing uses.
Eigen::MatrixXf fit_high(const std::vector<Exemplar>& exemplars, const Training& training, const SparseCodes& X, Eigen::Index atoms,
                         const LearnOptions& options) {
  const int side = options.patch_cells * options.factor;
  Eigen::MatrixXf right = Eigen::MatrixXf::Zero(Eigen::Index{side} * side, atoms);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(atoms, atoms);
  Eigen::VectorXf high(right.rows());
  for (Eigen::Index i = 0; i < X.count(); ++i) {
    cut_high(exemplars, training.sources[static_cast<std::size_t>(i)], training.means[static_cast<std::size_t>(i)], options, high);
    for (Eigen::Index t = 0; t < X.sparsity(); ++t) {
      const std::int32_t a = X.atoms(t, i);
      if (a < 0) continue;
      right.col(a) += X.coefficients(t, i) * high;
      for (Eigen::Index u = 0; u < X.sparsity(); ++u)
        if (X.atoms(u, i) >= 0)
          gram(a, X.atoms(u, i)) += static_cast<double>(X.coefficients(t, i)) * static_cast<double>(X.coefficients(u, i));
    }
  }
  gram.diagonal().array() += 1e-9 * std::max(gram.trace() / static_cast<double>(atoms), 1e-30);
  return gram.ldlt().solve(right.cast<double>().transpose()).transpose().cast<float>();
}

void learn_atoms(const std::vector<Exemplar>& exemplars, const Training& training, const LearnOptions& options, Dictionary& dictionary,
                 LearnReport& report, Progress& progress) {
  const auto atoms = static_cast<int>(std::min<std::int64_t>(options.atoms, training.patches.cols()));
  if (options.method == LearningMethod::all) {
    std::vector<std::int64_t> every(static_cast<std::size_t>(training.patches.cols()));
    std::iota(every.begin(), every.end(), 0);
    take_real_atoms(exemplars, training, every, options, dictionary);
  } else if (options.method == LearningMethod::constrained) {
    ConstrainedOptions constrained;
    constrained.atoms = atoms;
    constrained.sparsity = options.sparsity;
    constrained.exhaustive = options.exhaustive;
    constrained.seed = options.seed;
    constrained.threads = options.threads;
    const ConstrainedResult result = learn_constrained(training.patches, constrained, progress);
    report.objective = result.objective;
    take_real_atoms(exemplars, training, result.patches, options, dictionary);
  } else {
    KsvdOptions ksvd;
    ksvd.atoms = atoms;
    ksvd.sparsity = options.sparsity;
    ksvd.seed = options.seed;
    ksvd.threads = options.threads;
    const KsvdResult result = learn_ksvd(training.patches, ksvd, progress);
    report.objective = result.objective;
    dictionary.low = result.D;
    dictionary.high = fit_high(exemplars, training, result.X, result.D.cols(), options);
    dictionary.sources.assign(static_cast<std::size_t>(result.D.cols()), AtomSource{});
  }
}

}  // namespace

Dictionary learn_dictionary(const std::vector<Exemplar>& exemplars, const LearnOptions& options, LearnReport& report, Progress& progress) {
  check(exemplars, options);
  const Training training = gather(exemplars, options);
  report.patches = training.found;
  report.trained = training.patches.cols();
  Dictionary dictionary;
  dictionary.method = options.method;
  dictionary.patch_cells = options.patch_cells;
  dictionary.factor = options.factor;
  dictionary.cell_size_m = exemplars.front().cell_size_m * options.factor;
  for (const Exemplar& exemplar : exemplars) dictionary.exemplars.push_back(exemplar.name);
  learn_atoms(exemplars, training, options, dictionary, report, progress);
  if (options.detail) {
    std::vector<RasterView<const float>> cells;
    for (const Exemplar& exemplar : exemplars) cells.push_back(exemplar.cells);
    add_detail(dictionary, cells, options.threads, progress);
  }
  return dictionary;
}

}  // namespace arete
