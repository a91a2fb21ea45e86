#include "core/sparse/ksvd.h"

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "core/support/error.h"
#include "tests/core/sparse/learning_data.h"

namespace arete {
namespace {

KsvdResult learn(const Eigen::MatrixXf& F, KsvdOptions options) {
  NoProgress progress;
  return learn_ksvd(F, options, progress);
}

double objective_of(const Eigen::MatrixXf& F, const KsvdResult& result) {
  return (F.cast<double>() - decode(result.D, result.X).cast<double>()).squaredNorm();
}

TEST(Ksvd, ObjectiveNeverRisesAndIsThatOfTheResult) {
  const Eigen::MatrixXf F = hill_patches(120, 1, 8, 2);
  for (const bool exact : {false, true})
    for (const int sparsity : {1, 3}) {
      const KsvdResult result = learn(F, {.atoms = 40, .sparsity = sparsity, .iterations = 8, .exact_update = exact});
      ASSERT_GE(result.objective.size(), 3u);
      for (std::size_t i = 1; i < result.objective.size(); ++i) EXPECT_LE(result.objective[i], result.objective[i - 1]);
      EXPECT_LT(result.objective.back(), 0.8 * result.objective.front());
      EXPECT_NEAR(objective_of(F, result), result.objective.back(), 1e-3 * result.objective.back());
    }
}

TEST(Ksvd, AtomsAreUnitAndCodesSparse) {
  const KsvdResult result = learn(hill_patches(100, 2, 6, 2), {.atoms = 50, .sparsity = 2, .iterations = 5});
  for (Eigen::Index j = 0; j < 50; ++j) EXPECT_NEAR(result.D.col(j).norm(), 1, 1e-6);
  EXPECT_EQ(result.X.sparsity(), 2);
}

TEST(Ksvd, OneAtomIsTheLeadingSingularVector) {
  const Eigen::MatrixXf F = hill_patches(80, 3, 6, 3);
  const KsvdResult result = learn(F, {.atoms = 1, .sparsity = 1, .iterations = 3, .exact_update = true});
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(F.cast<double>() * F.cast<double>().transpose(), Eigen::ComputeFullU);
  EXPECT_NEAR(std::abs(svd.matrixU().col(0).dot(result.D.col(0).cast<double>())), 1, 1e-5);
  EXPECT_NEAR(result.objective.back(), F.cast<double>().squaredNorm() - svd.singularValues()[0], 1e-4 * F.squaredNorm());
}

TEST(Ksvd, RecoversADictionaryThatMadeTheSignals) {
  // 300 signals, each a multiple of one of 5 orthogonal directions: five atoms represent all of them.
  Eigen::MatrixXf F = Eigen::MatrixXf::Zero(10, 300);
  for (int i = 0; i < 300; ++i) F(2 * (i % 5), i) = static_cast<float>(0.5 + uniform_at(4, i));
  const KsvdResult result = learn(F, {.atoms = 5, .sparsity = 1, .iterations = 20});
  EXPECT_LT(result.objective.back(), 1e-6 * F.squaredNorm());
}

TEST(Ksvd, UnusedAtomsAreSeededAgain) {
  // All but one patch are the same: at the start at least two of the three atoms coincide and one of them has no use.
  Eigen::MatrixXf F = Eigen::MatrixXf::Zero(4, 20);
  F.row(0).setOnes();
  F.col(7) << 0, 1, 0, 0;
  F.col(13) << 0, 0, 1, 0;
  const KsvdResult result = learn(F, {.atoms = 3, .sparsity = 1, .iterations = 5});
  EXPECT_TRUE(result.D.allFinite());
  EXPECT_LT(result.objective.back(), 1e-9);
}

TEST(Ksvd, SameSeedSameBytesForAnyNumberOfThreads) {
  const Eigen::MatrixXf F = hill_patches(110, 5, 8, 2);
  const KsvdResult one = learn(F, {.atoms = 32, .sparsity = 2, .iterations = 4, .seed = 9, .threads = 1});
  const KsvdResult two = learn(F, {.atoms = 32, .sparsity = 2, .iterations = 4, .seed = 9, .threads = 2});
  const KsvdResult other = learn(F, {.atoms = 32, .sparsity = 2, .iterations = 4, .seed = 10});
  EXPECT_EQ(one.D, two.D);
  EXPECT_EQ(one.X.atoms, two.X.atoms);
  EXPECT_EQ(one.X.coefficients, two.X.coefficients);
  EXPECT_NE(one.D, other.D);
}

TEST(Ksvd, RefusesFewerPatchesThanAtoms) {
  EXPECT_THROW(learn(hill_patches(20, 6, 8, 4), {.atoms = 500}), Error);
}

}  // namespace
}  // namespace arete
