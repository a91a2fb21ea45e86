#include "core/sparse/constrained.h"

#include <set>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "tests/core/sparse/learning_data.h"

namespace arete {
namespace {

ConstrainedResult learn(const Eigen::MatrixXf& F, ConstrainedOptions options) {
  NoProgress progress;
  return learn_constrained(F, options, progress);
}

TEST(Constrained, EveryAtomIsANormalisedPatchBitForBit) {
  const Eigen::MatrixXf F = hill_patches(120, 1, 8, 2);
  const ConstrainedResult result = learn(F, {.atoms = 40, .iterations = 6});
  const Eigen::MatrixXf units = F.colwise().normalized();
  std::set<std::int64_t> different;
  for (Eigen::Index j = 0; j < 40; ++j) {
    const std::int64_t patch = result.patches[static_cast<std::size_t>(j)];
    EXPECT_EQ(result.D.col(j), units.col(patch));
    different.insert(patch);
  }
  EXPECT_EQ(different.size(), 40u);
}

TEST(Constrained, ObjectiveNeverRisesAndIsThatOfTheResult) {
  const Eigen::MatrixXf F = hill_patches(120, 2, 8, 2);
  for (const bool exhaustive : {false, true})
    for (const int sparsity : {1, 3}) {
      const ConstrainedResult result = learn(F, {.atoms = 40, .sparsity = sparsity, .iterations = 6, .exhaustive = exhaustive});
      ASSERT_GE(result.objective.size(), 2u);
      for (std::size_t i = 1; i < result.objective.size(); ++i) EXPECT_LE(result.objective[i], result.objective[i - 1]);
      if (sparsity == 1) {
        EXPECT_LT(result.objective.back(), 0.95 * result.objective.front());
      }
      const double objective = (F.cast<double>() - decode(result.D, result.X).cast<double>()).squaredNorm();
      EXPECT_NEAR(objective, result.objective.back(), 1e-3 * result.objective.back());
    }
}

TEST(Constrained, CandidatesComeCloseToTheExhaustiveSearch) {
  const Eigen::MatrixXf F = hill_patches(130, 3, 8, 2);
  const double quick = learn(F, {.atoms = 48}).objective.back();
  const double exhaustive = learn(F, {.atoms = 48, .exhaustive = true}).objective.back();
  EXPECT_LT(quick, 1.05 * exhaustive);
}

TEST(Constrained, SameSeedSameBytesForAnyNumberOfThreads) {
  const Eigen::MatrixXf F = hill_patches(110, 4, 8, 2);
  const ConstrainedResult one = learn(F, {.atoms = 32, .sparsity = 2, .iterations = 4, .seed = 9, .threads = 1});
  const ConstrainedResult two = learn(F, {.atoms = 32, .sparsity = 2, .iterations = 4, .seed = 9, .threads = 2});
  EXPECT_EQ(one.patches, two.patches);
  EXPECT_EQ(one.X.coefficients, two.X.coefficients);
}

TEST(Constrained, AsManyAtomsAsPatchesRepresentAll) {
  const Eigen::MatrixXf F = hill_patches(30, 5, 8, 4);
  const ConstrainedResult result = learn(F, {.atoms = static_cast<int>(F.cols())});
  EXPECT_LT(result.objective.back(), 1e-9 * F.squaredNorm());
}

TEST(Constrained, RefusesFewerPatchesThanAtoms) {
  EXPECT_THROW(learn(hill_patches(20, 6, 8, 4), {.atoms = 500}), Error);
}

}  // namespace
}  // namespace arete
