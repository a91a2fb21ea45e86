#include "core/sparse/patches.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

Raster<float> random_terrain(std::int64_t width, std::int64_t height, std::uint64_t seed) {
  Raster<float> terrain(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) terrain(x, y) = static_cast<float>(1000 * uniform_at(seed, x, y));
  return terrain;
}

TEST(Patches, AreCellsMinusMeanTimesWeight) {
  const Raster<float> terrain = random_terrain(13, 11, 1);
  const PatchGrid grid = make_patch_grid(6);
  const Patches patches = extract_patches(terrain.view(), grid);
  ASSERT_EQ(patches.count(), 3 * 2);
  for (std::int64_t i = 0; i < patches.count(); ++i) {
    const PatchOrigin origin = patches.origins[i];
    double sum = 0;
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x) sum += terrain(origin.x + x, origin.y + y);
    EXPECT_NEAR(patches.means[i], sum / 36, 1e-9);
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x)
        EXPECT_NEAR(patches.values(y * 6 + x, i), (terrain(origin.x + x, origin.y + y) - sum / 36) * grid.weights[y * 6 + x], 1e-4);
  }
}

TEST(Patches, WithAVoidAreLeftOut) {
  Raster<float> terrain = random_terrain(16, 8, 2);
  terrain(9, 3) = void_value;
  const Patches patches = extract_patches(terrain.view(), make_patch_grid(8));
  ASSERT_EQ(patches.count(), 1);
  EXPECT_EQ(patches.origins[0].x, 0);
  EXPECT_TRUE(patches.values.allFinite());
}

TEST(Patches, FlatOnesAreLeftOutOfDictionariesOnly) {
  Raster<float> terrain(16, 8, 3000.1f);
  for (std::int64_t x = 8; x < 16; ++x) terrain(x, 4) = 3001.1f;
  PatchOptions options;
  EXPECT_EQ(extract_patches(terrain.view(), make_patch_grid(8), options).count(), 3);
  options.leave_out_flat = true;
  const Patches patches = extract_patches(terrain.view(), make_patch_grid(8), options);
  ASSERT_EQ(patches.count(), 2);
  EXPECT_EQ(patches.origins[0].x, 4);
}

TEST(Patches, BeyondTheBorderTheEdgeRepeats) {
  const Raster<float> terrain = random_terrain(5, 4, 3);
  PatchOptions options;
  options.edges = PatchEdges::replicate;
  const PatchGrid grid = make_patch_grid(4);
  const Patches patches = extract_patches(terrain.view(), grid, options);
  ASSERT_EQ(patches.count(), patches_along(grid, 5) * patches_along(grid, 4));
  // The first patch begins at (-2, -2): its first 3 x 3 cells all repeat cell (0, 0).
  float cells[16];
  ASSERT_TRUE(cut_cells(terrain.view(), -2, -2, 4, 0, cells));
  for (const int i : {0, 1, 2, 4, 5, 6, 8, 9, 10}) EXPECT_EQ(cells[i], terrain(0, 0));
  EXPECT_EQ(cells[15], terrain(1, 1));
}

TEST(Patches, SymmetriesAreTheEightOfASquare) {
  const Raster<float> terrain = random_terrain(4, 4, 4);
  PatchOptions options;
  options.symmetries = true;
  const Patches patches = extract_patches(terrain.view(), make_patch_grid(4), options);
  ASSERT_EQ(patches.count(), 8);
  std::set<std::vector<float>> distinct;
  for (std::int64_t i = 0; i < 8; ++i) {
    std::vector<float> values(patches.values.col(i).begin(), patches.values.col(i).end());
    EXPECT_NEAR(patches.values.col(i).norm(), patches.values.col(0).norm(), 1e-3);
    EXPECT_EQ(patches.origins[i].symmetry, i);
    distinct.insert(values);
  }
  EXPECT_EQ(distinct.size(), 8u);
  // Transposed first, then mirrored in x: sample (x, y) is cell (y, m - 1 - x).
  float cells[16];
  ASSERT_TRUE(cut_cells(terrain.view(), 0, 0, 4, 4 | 1, cells));
  EXPECT_EQ(cells[1 * 4 + 3], terrain(1, 0));
}

TEST(Patches, AreTheSameForAnyNumberOfThreads) {
  const Raster<float> terrain = random_terrain(60, 50, 5);
  PatchOptions one, two;
  one.threads = 1;
  two.threads = 2;
  EXPECT_EQ(extract_patches(terrain.view(), make_patch_grid(8, 2), one).values,
            extract_patches(terrain.view(), make_patch_grid(8, 2), two).values);
}

TEST(Patches, TooSmallARasterHasNone) {
  const Raster<float> terrain = random_terrain(6, 4, 6);
  EXPECT_EQ(extract_patches(terrain.view(), make_patch_grid(8)).count(), 0);
}

}  // namespace
}  // namespace arete
