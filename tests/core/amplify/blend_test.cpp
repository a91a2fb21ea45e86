#include "core/amplify/blend.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/sparse/patches.h"
#include "core/support/error.h"
#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

struct Layout {
  int patch, pitch, factor;
};
const Layout layouts[] = {{8, 4, 4}, {8, 2, 4}, {8, 4, 3}, {6, 2, 2}, {6, 3, 5}, {16, 4, 2}, {8, 4, 1}, {4, 1, 4}};

/// Sum over the patches above each place of the period of a power of the weights.
double sum_at(const std::vector<float>& weights, const Layout& l, int x, int y, int power) {
  const int side = l.patch * l.factor, period = l.pitch * l.factor;
  double sum = 0;
  for (int j = y; j < side; j += period)
    for (int i = x; i < side; i += period) sum += std::pow(static_cast<double>(weights[static_cast<std::size_t>(j * side + i)]), power);
  return sum;
}

TEST(BlendingWeights, OfAMeanArePartitionOfUnityAndOfAVarianceTheirSquares) {
  for (const Layout& l : layouts) {
    const PatchGrid grid = make_patch_grid(l.patch, l.pitch);
    const auto mean = blending_weights(grid, l.factor, Blending::mean), variance = blending_weights(grid, l.factor, Blending::variance);
    for (int y = 0; y < l.pitch * l.factor; ++y)
      for (int x = 0; x < l.pitch * l.factor; ++x) {
        EXPECT_NEAR(sum_at(mean, l, x, y, 1), 1, 1e-6);
        EXPECT_NEAR(sum_at(variance, l, x, y, 2), 1, 1e-6);
      }
  }
}

TEST(BlendingWeights, AreProportionalToTheDisc) {
  const PatchGrid grid = make_patch_grid(8, 4);
  const auto mean = blending_weights(grid, 4, Blending::mean), disc = disc_weights(32);
  // Cells one period (16) apart share their normaliser.
  for (std::size_t y = 0; y < 32; ++y)
    for (std::size_t x = 0; x < 16; ++x) EXPECT_NEAR(mean[32 * y + x] * disc[32 * y + x + 16], mean[32 * y + x + 16] * disc[32 * y + x], 1e-7);
  for (std::size_t i = 0; i < mean.size(); ++i) EXPECT_EQ(mean[i] == 0, disc[i] == 0);
}

TEST(BlendingWeights, RefuseAPitchThatDoesNotDivideThePatch) {
  try {
    blending_weights(make_patch_grid(8, 3), 4, Blending::mean);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(e.what()).find("divisor"), std::string::npos) << e.what();
  }
}

TEST(Blend, WeighAtomsMultipliesEachColumn) {
  const PatchGrid grid = make_patch_grid(6, 3);
  const auto weights = blending_weights(grid, 2, Blending::mean);
  Eigen::MatrixXf atoms = Eigen::MatrixXf::Random(144, 600);
  const Eigen::MatrixXf before = atoms;
  weigh_atoms(atoms, weights, 2);
  for (const Eigen::Index j : {0, 255, 256, 599})
    for (Eigen::Index i = 0; i < 144; ++i) EXPECT_EQ(atoms(i, j), before(i, j) * weights[static_cast<std::size_t>(i)]);
}

/// A terrain as the patches of itself: its own dictionary, complete, at its own resolution.
struct Rebuilt {
  Rebuilt(const Raster<float>& terrain, const Layout& l) : grid(make_patch_grid(l.patch, l.pitch)) {
    const Patches patches = extract_patches(terrain.view(), grid, {PatchEdges::replicate, false, false, 2});
    columns = patches_along(grid, terrain.width());
    means = patches.means;
    Eigen::MatrixXf units = patches.values.colwise().normalized();
    codes = omp(prepare_coding(units, 1), patches.values, 1);
    atoms.resize(grid.samples(), patches.count());
    std::vector<float> cells(static_cast<std::size_t>(grid.samples()));
    for (std::int64_t j = 0; j < patches.count(); ++j) {
      const auto& origin = patches.origins[static_cast<std::size_t>(j)];
      cut_cells(terrain.view(), origin.x, origin.y, l.patch, 0, cells.data());
      const double norm = patches.values.col(j).cast<double>().norm();
      for (std::size_t k = 0; k < cells.size(); ++k)
        atoms(static_cast<Eigen::Index>(k), j) = static_cast<float>((static_cast<double>(cells[k]) - means[static_cast<std::size_t>(j)]) / norm);
    }
    weights = blending_weights(grid, 1, Blending::mean);
    weigh_atoms(atoms, weights, 1);
  }
  PatchTerms terms(std::int64_t column, std::int64_t row) const {
    const std::int64_t i = row * columns + column;
    return {means[static_cast<std::size_t>(i)], true, 1, codes.atoms.col(i).data(), codes.coefficients.col(i).data()};
  }
  Raster<float> blend(const Window& window, int threads) const {
    Raster<float> out(window.width, window.height);
    blend_patches(grid, 1, window, weights, atoms, [&](std::int64_t c, std::int64_t r) { return terms(c, r); }, out.view(), threads);
    return out;
  }
  PatchGrid grid;
  std::int64_t columns = 0;
  std::vector<double> means;
  SparseCodes codes;
  Eigen::MatrixXf atoms;
  std::vector<float> weights;
};

// Exactness of the sparse terrain model: all patches as the dictionary, one atom each, give the terrain back.
TEST(Blend, ACompleteDictionaryRebuildsItsOwnTerrain) {
  for (const Layout& l : {Layout{8, 4, 1}, Layout{8, 2, 1}, Layout{6, 3, 1}}) {
    const Raster<float> low = fractal_terrain(45, 37, 1, 2, 20, 100);
    EXPECT_LT(largest_difference(Rebuilt(low, l).blend({0, 0, 45, 37}, 2).view(), low.view()), 1e-5 + 0x1p-17);  // one spacing below 128 m
    const Raster<float> high = fractal_terrain(45, 37, 2, 2, 2000, 100);
    EXPECT_LT(largest_difference(Rebuilt(high, l).blend({0, 0, 45, 37}, 2).view(), high.view()), 1.5 * 0x1p-13);
  }
}

TEST(Blend, NeitherWindowNorThreadsChangeABit) {
  const Raster<float> terrain = fractal_terrain(61, 53, 3);
  const Rebuilt rebuilt(terrain, {8, 4, 1});
  const Raster<float> whole = rebuilt.blend({0, 0, 61, 53}, 1);
  for (const int threads : {2, 3, 7}) EXPECT_TRUE(same_bits(whole.view(), rebuilt.blend({0, 0, 61, 53}, threads).view()));
  for (const Window& w : {Window{0, 0, 1, 1}, Window{3, 5, 9, 2}, Window{17, 11, 44, 42}, Window{60, 0, 1, 53}})
    EXPECT_TRUE(same_bits(rebuilt.blend(w, 2).view(), whole.view().sub(w)));
}

TEST(Blend, EqualOffsetsAloneAreReturnedToTheLastBit) {
  const PatchGrid grid = make_patch_grid(8, 4);
  const auto weights = blending_weights(grid, 4, Blending::mean);
  const Eigen::MatrixXf none;
  Raster<float> out(80, 60);
  blend_patches(grid, 4, {-7, 5, 20, 15}, weights, none, [](std::int64_t, std::int64_t) { return PatchTerms{4321.123, true, 0, nullptr, nullptr}; },
                out.view(), 2);
  for (std::int64_t i = 0; i < out.size().cells(); ++i) ASSERT_EQ(out.data()[i], 4321.123f);
}

TEST(Blend, APlaceThatOnlyUnknownPatchesTouchGetsZero) {
  const PatchGrid grid = make_patch_grid(8, 4);
  const auto weights = blending_weights(grid, 1, Blending::mean);
  const Eigen::MatrixXf none;
  Raster<float> out(40, 8);
  blend_patches(grid, 1, {0, 0, 40, 8}, weights, none,
                [](std::int64_t column, std::int64_t) { return PatchTerms{100, column < 4, 0, nullptr, nullptr}; }, out.view(), 1);
  // Patches 0 to 3 lie over columns -4 to 15.
  EXPECT_EQ(out(15, 3), 100);
  EXPECT_EQ(out(16, 3), 0);
}

TEST(Blend, TermsWithoutAtomAreLeftOut) {
  const PatchGrid grid = make_patch_grid(8, 4);
  const auto weights = blending_weights(grid, 1, Blending::mean);
  Eigen::MatrixXf atoms = Eigen::MatrixXf::Ones(64, 1);
  weigh_atoms(atoms, weights, 1);
  static constexpr std::int32_t chosen[] = {0, -1};
  static constexpr float factors[] = {2.5f, 0};
  Raster<float> out(12, 12);
  blend_patches(grid, 1, {0, 0, 12, 12}, weights, atoms, [](std::int64_t, std::int64_t) { return PatchTerms{10, true, 2, chosen, factors}; },
                out.view(), 1);
  for (std::int64_t i = 0; i < 144; ++i) EXPECT_NEAR(out.data()[i], 12.5, 1e-5);
}

}  // namespace
}  // namespace arete
