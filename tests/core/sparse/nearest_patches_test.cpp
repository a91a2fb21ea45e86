#include "core/sparse/nearest_patches.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/sparse/main_directions.h"
#include "tests/core/sparse/learning_data.h"

namespace arete {
namespace {

TEST(NearestPatches, AreThoseOfABruteForceSearchInTheLeadingCoordinates) {
  const Eigen::MatrixXf units = hill_patches(80, 1, 6, 2).colwise().normalized();
  const NearestPatches nearest(units);
  const Eigen::MatrixXf coordinates = main_directions(units, NearestPatches::coordinates).cast<float>() * units;
  for (const Eigen::Index q : {0, 17, 333}) {
    const auto found = nearest.find(-units.col(q), 10);
    ASSERT_EQ(found.size(), 10u);
    Eigen::VectorXf distances = (coordinates.colwise() + coordinates.col(q)).colwise().squaredNorm();
    std::vector<float> sorted(distances.begin(), distances.end());
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(distances[found[i]], sorted[i], 1e-5);
  }
}

TEST(NearestPatches, GivesNoMoreThanThereAre) {
  const Eigen::MatrixXf units = hill_patches(20, 2, 8, 4).colwise().normalized();
  EXPECT_EQ(static_cast<Eigen::Index>(NearestPatches(units).find(units.col(0), 1000).size()), units.cols());
}

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
