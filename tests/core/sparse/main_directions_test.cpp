#include "core/sparse/main_directions.h"

#include <gtest/gtest.h>

#include "tests/core/sparse/learning_data.h"

namespace arete {
namespace {

TEST(MainDirections, AreOrthonormal) {
  const Eigen::MatrixXf F = hill_patches(80, 3, 8, 2);
  const Eigen::MatrixXd basis = main_directions(F, 8);
  EXPECT_LT((basis * basis.transpose() - Eigen::MatrixXd::Identity(8, 8)).cwiseAbs().maxCoeff(), 1e-12);
  // They hold nearly all that patches of terrain have.
  EXPECT_GT((basis * F.cast<double>()).squaredNorm(), 0.9 * F.cast<double>().squaredNorm());
}

TEST(MainDirections, BeyondTheDimensionAreZero) {
  const Eigen::MatrixXd basis = main_directions(Eigen::MatrixXf::Identity(3, 3), 5);
  EXPECT_EQ(basis.bottomRows(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_LT((basis.topRows(3) * basis.topRows(3).transpose() - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-12);
}

}  // namespace
}  // namespace arete
