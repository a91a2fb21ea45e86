#include "core/sparse/atom_search.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/sparse/patches.h"
#include "tests/core/sparse/learning_data.h"
#include "tests/core/sparse/random_matrix.h"
#include "tests/data.h"

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

// The two DEMs of the development data that need no library: raw floats, and text.
Raster<float> read_gabilan(const std::string& path) {
  Raster<float> terrain(921, 859);
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(terrain.data()), 921 * 859 * sizeof(float));
  return terrain;
}
Raster<float> read_hit(const std::string& path) {
  Raster<float> terrain(526, 446);
  std::ifstream file(path);
  std::string line;
  for (int i = 0; i < 6; ++i) std::getline(file, line);
  for (std::int64_t i = 0; i < terrain.size().cells(); ++i) {
    file >> terrain.data()[i];
    if (terrain.data()[i] == -9999) terrain.data()[i] = void_value;
  }
  EXPECT_TRUE(file.good() || file.eof());
  return terrain;
}

Eigen::MatrixXf patches_of(const Raster<float>& terrain, int cells, int pitch) {
  PatchOptions options;
  options.leave_out_flat = true;
  return extract_patches(terrain.view(), PatchGrid{cells, pitch, disc_weights(cells)}, options).values;
}

TEST(AtomSearch, IsThePlainSearchOnRealTerrain) {
  const std::string lidar = test_data("gabilan_lidar_1m.bil"), mountain = test_data("hit_tyrol_dtm_5m.asc");
  if (lidar.empty() || mountain.empty()) GTEST_SKIP() << "needs the development data: set ARETE_TEST_DATA";
  const Raster<float> hills_1m = read_gabilan(lidar), alps_5m = read_hit(mountain);
  for (const int cells : {6, 8}) {
    expect_same_as_plain_search(patches_of(hills_1m, cells, 5).colwise().normalized(), patches_of(alps_5m, cells, 11));
    expect_same_as_plain_search(patches_of(alps_5m, cells, 3).colwise().normalized(), patches_of(hills_1m, cells, 17));
  }
}

TEST(AtomSearch, IsThePlainSearchOnTerrain) {
  for (const int cells : {4, 6, 8, 12}) {
    const Eigen::MatrixXf D = hill_patches(150, 1, cells, 2).colwise().normalized();
    expect_same_as_plain_search(D, hill_patches(60, 2, cells, 2));
  }
}

TEST(AtomSearch, IsThePlainSearchOnNoise) {
  expect_same_as_plain_search(random_matrix(20, 3000, 3).colwise().normalized(), random_matrix(20, 300, 4));
}

TEST(AtomSearch, FindsTheAtomsThemselvesAndTheirNegatives) {
  Eigen::MatrixXf D = hill_patches(120, 5, 8, 3).colwise().normalized();
  D.col(D.cols() - 1) = D.col(7);   // of equals the lowest index
  D.col(D.cols() - 2) = -D.col(9);
  expect_same_as_plain_search(D, -1000 * D);
}

TEST(AtomSearch, WorksForAnyNumberOfAtoms) {
  const Eigen::MatrixXf D = hill_patches(120, 6, 6, 2).colwise().normalized();
  const Eigen::MatrixXf F = hill_patches(40, 7, 6, 3);
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
