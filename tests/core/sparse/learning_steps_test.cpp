#include "core/sparse/learning_steps.h"

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "tests/core/sparse/learning_data.h"
#include "tests/core/sparse/random_matrix.h"

namespace arete {
namespace {

TEST(LearningSteps, ChosenColumnsAreDifferentAndAscending) {
  const auto chosen = choose_columns(1000, 100, 3);
  ASSERT_EQ(chosen.size(), 100u);
  for (std::size_t i = 1; i < chosen.size(); ++i) EXPECT_LT(chosen[i - 1], chosen[i]);
  EXPECT_EQ(choose_columns(5, 10, 3).size(), 5u);
}

TEST(LearningSteps, ImprovedCodesAreNeverWorse) {
  const Eigen::MatrixXf F = hill_patches(60, 1, 6, 2);
  const Eigen::MatrixXf first = random_dictionary(36, 30, 2), second = random_dictionary(36, 30, 3);
  SparseCodes X;
  improve_codes(F, first, 3, 0, X);
  const SparseCodes old = X;
  const Eigen::VectorXd before = squared_residuals(F, second, old);  // codes of another dictionary: poor ones
  const Eigen::VectorXd after = improve_codes(F, second, 3, 0, X);
  for (Eigen::Index i = 0; i < F.cols(); ++i) EXPECT_LE(after[i], before[i]);
  EXPECT_EQ(after, squared_residuals(F, second, X));
}

TEST(LearningSteps, LeadingDirectionIsTheSingularVectorAndNeverFalls) {
  const Eigen::MatrixXf E = random_matrix(12, 40, 4);
  const Eigen::VectorXf start = random_dictionary(12, 1, 5);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(E.cast<double>(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  EXPECT_NEAR(std::abs(svd.matrixU().col(0).dot(leading_direction(E, start, 2000).cast<double>())), 1, 1e-4);
  float before = (E.transpose() * start).norm();
  for (int rounds = 1; rounds < 8; ++rounds) {
    const float now = (E.transpose() * leading_direction(E, start, rounds)).norm();
    EXPECT_GE(now, before * (1 - 1e-6f));
    before = now;
  }
  EXPECT_EQ(leading_direction(Eigen::MatrixXf::Zero(12, 3), start, 5), start);
}

TEST(LearningSteps, PlacingAnAtomGivesItsBestCoefficients) {
  const Eigen::MatrixXf F = hill_patches(50, 6, 6, 3);
  Eigen::MatrixXf D = random_dictionary(36, 10, 7);
  SparseCodes X;
  improve_codes(F, D, 2, 0, X);
  Eigen::MatrixXf R = F - decode(D, X);
  const double before = R.cast<double>().squaredNorm();
  const auto uses = uses_of_atoms(X, 10);
  for (Eigen::Index j = 0; j < 10; ++j) {
    const auto& used = uses[static_cast<std::size_t>(j)];
    const Eigen::MatrixXf E = errors_without(R, D.col(j), used, X);
    place_atom(D.col(j), E, used, X, R);
  }
  EXPECT_LE(R.cast<double>().squaredNorm(), before * (1 + 1e-6));
  EXPECT_LT((R - (F - decode(D, X))).cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace arete
