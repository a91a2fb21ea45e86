#include "core/sparse/atom_search.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/sparse/patches.h"
#include "core/support/random.h"

namespace arete {
namespace {

void expect_same_as_plain_search(const Eigen::MatrixXf& D, const Eigen::MatrixXf& F) {
  std::vector<Match> expected(static_cast<std::size_t>(F.cols())), found(expected.size());
  strongest_atoms(PackedAtoms(D), F.data(), F.cols(), F.rows(), expected.data());
  AtomSearch(D).strongest(F.data(), F.cols(), F.rows(), found.data());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].atom, expected[i].atom) << i;
    ASSERT_EQ(found[i].correlation, expected[i].correlation) << i;
  }
}

// Hills with detail at every scale, in whole decimetres: terrain enough to have a few main directions.
Raster<float> hills(std::int64_t size, std::uint64_t seed) {
  Raster<float> terrain(size, size, 0.0f);
  for (std::int64_t y = 0; y < size; ++y)
    for (std::int64_t x = 0; x < size; ++x) {
      double z = 1000 + 0.2 * uniform_at(seed, x, y);
      for (int o = 0; o < 6; ++o)
        z += 40 * std::pow(0.45, o) * std::sin(x * 0.05 * std::pow(1.9, o) + 6 * uniform_at(seed, o)) *
             std::cos(y * 0.045 * std::pow(2.1, o) + 6 * uniform_at(seed, o, 1));
      terrain(x, y) = static_cast<float>(std::round(z * 10) / 10);
    }
  return terrain;
}

Eigen::MatrixXf patches_of(const Raster<float>& terrain, int cells, int pitch) {
  PatchOptions options;
  options.leave_out_flat = true;
  return extract_patches(terrain.view(), make_patch_grid(cells, pitch), options).values;
}

Eigen::MatrixXf random_matrix(std::int64_t rows, std::int64_t columns, std::uint64_t seed) {
  Eigen::MatrixXf values(rows, columns);
  for (std::int64_t j = 0; j < columns; ++j)
    for (std::int64_t i = 0; i < rows; ++i) values(i, j) = static_cast<float>(uniform_at(seed, i, j) - 0.5);
  return values;
}

TEST(AtomSearch, IsThePlainSearchOnTerrain) {
  for (const int cells : {4, 6, 8, 12}) {
    const Eigen::MatrixXf D = patches_of(hills(150, 1), cells, 2).colwise().normalized();
    expect_same_as_plain_search(D, patches_of(hills(60, 2), cells, 2));
  }
}

TEST(AtomSearch, IsThePlainSearchOnNoise) {
  expect_same_as_plain_search(random_matrix(20, 3000, 3).colwise().normalized(), random_matrix(20, 300, 4));
}

TEST(AtomSearch, FindsTheAtomsThemselvesAndTheirNegatives) {
  Eigen::MatrixXf D = patches_of(hills(120, 5), 8, 3).colwise().normalized();
  D.col(D.cols() - 1) = D.col(7);   // of equals the lowest index
  D.col(D.cols() - 2) = -D.col(9);
  expect_same_as_plain_search(D, -1000 * D);
}

TEST(AtomSearch, WorksForAnyNumberOfAtoms) {
  const Eigen::MatrixXf D = patches_of(hills(120, 6), 6, 2).colwise().normalized();
  const Eigen::MatrixXf F = patches_of(hills(40, 7), 6, 3);
  for (const int atoms : {1, 2, 15, 16, 17, 255, 256, 257, 1023, 1025}) expect_same_as_plain_search(D.leftCols(atoms), F);
}

TEST(AtomSearch, ASignalOfNothingGetsNothing) {
  const Eigen::MatrixXf D = random_matrix(16, 100, 8).colwise().normalized();
  Eigen::MatrixXf F = random_matrix(16, 3, 9);
  F.col(1).setZero();
  expect_same_as_plain_search(D, F);
}

}  // namespace
}  // namespace arete
