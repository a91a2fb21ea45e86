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

}  // namespace
}  // namespace arete
