#include "core/sparse/correlate.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/core/sparse/random_matrix.h"

namespace arete {
namespace {

TEST(Correlate, IsTheProductOfAtomsAndSignals) {
  const Eigen::MatrixXf D = random_dictionary(37, 45, 1), F = random_matrix(37, 19, 2);
  const PackedAtoms atoms(D);
  EXPECT_EQ(atoms.padded_atoms(), 48);
  Eigen::MatrixXf products(48, 19);
  correlate(atoms, F.data(), 19, 37, products.data());
  EXPECT_LT((products.topRows(45) - D.transpose() * F).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_EQ(products.bottomRows(3).cwiseAbs().maxCoeff(), 0);
}

TEST(StrongestAtoms, AreTheFirstOfTheLargestCorrelations) {
  Eigen::MatrixXf D = random_dictionary(24, 100, 3);
  D.col(71) = D.col(5);
  D.col(40) = -D.col(6);
  Eigen::MatrixXf F = random_matrix(24, 50, 4);
  F.col(10) = 3 * D.col(71);
  F.col(11) = -2 * D.col(40);
  F.col(12).setZero();
  const PackedAtoms atoms(D);
  std::vector<Match> best(50);
  strongest_atoms(atoms, F.data(), 50, 24, best.data());
  Eigen::MatrixXf products(atoms.padded_atoms(), 50);
  correlate(atoms, F.data(), 50, 24, products.data());
  for (int i = 0; i < 50; ++i) {
    Eigen::Index expected;
    products.col(i).cwiseAbs().maxCoeff(&expected);
    EXPECT_EQ(best[i].atom, expected);
    EXPECT_EQ(best[i].correlation, products(expected, i));  // the same bits
  }
  EXPECT_EQ(best[10].atom, 5);
  EXPECT_EQ(best[11].atom, 6);
  EXPECT_EQ(best[12].correlation, 0);
}

TEST(Correlate, EveryFunctionGivesTheSameBits) {
  const Eigen::MatrixXf D = random_dictionary(64, 50, 5), F = random_matrix(64, 23, 6);
  const PackedAtoms atoms(D);
  Eigen::MatrixXf products(atoms.padded_atoms(), 23), alone(atoms.padded_atoms(), 1);
  correlate(atoms, F.data(), 23, 64, products.data());
  for (int i = 0; i < 23; ++i) {
    correlate(atoms, F.col(i).data(), 1, 64, alone.data());
    EXPECT_EQ(alone.col(0), products.col(i));
    for (int j = 0; j < 50; ++j) EXPECT_EQ(correlation(D.col(j).data(), F.col(i).data(), 64), products(j, i));
  }
}

TEST(Strongest, IsThatOfTheDifference) {
  const Eigen::MatrixXf values = random_matrix(96, 4, 7);
  const float* columns[3] = {values.col(1).data(), values.col(2).data(), values.col(3).data()};
  const float factors[3] = {0.5f, -2.0f, 0.25f};
  const Eigen::VectorXf left = values.col(0) - 0.5f * values.col(1) + 2.0f * values.col(2) - 0.25f * values.col(3);
  Eigen::Index expected;
  left.cwiseAbs().maxCoeff(&expected);
  const Match match = subtract_and_find_strongest(values.col(0).data(), columns, factors, 3, 96);
  EXPECT_EQ(match.atom, expected);
  EXPECT_NEAR(match.correlation, left[expected], 1e-5);
  EXPECT_EQ(strongest(values.col(0).data(), 96).correlation, values(strongest(values.col(0).data(), 96).atom, 0));
}

TEST(Strongest, OfEqualsIsTheFirst) {
  std::vector<float> values(64, 0.0f);
  for (const int first : {0, 3, 15, 16, 33}) {
    std::fill(values.begin(), values.end(), 0.0f);
    for (std::size_t j = static_cast<std::size_t>(first); j < values.size(); j += 5) values[j] = j % 2 ? 4.0f : -4.0f;
    EXPECT_EQ(strongest(values.data(), 64).atom, first);
    EXPECT_EQ(strongest(values.data(), 64).correlation, first % 2 ? 4.0f : -4.0f);
  }
}

}  // namespace
}  // namespace arete
