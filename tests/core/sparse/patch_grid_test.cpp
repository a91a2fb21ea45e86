#include "core/sparse/patch_grid.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/sparse/falloff.h"
#include "core/support/error.h"

namespace arete {
namespace {

TEST(Falloff, HasTheValuesOfItsFormula) {
  EXPECT_EQ(falloff(0), 1);
  EXPECT_EQ(falloff(1), 0);
  EXPECT_EQ(falloff(1.5), 0);
  EXPECT_DOUBLE_EQ(falloff(0.5), 27.0 / 64);
}

TEST(Falloff, VanishesWithItsFirstTwoDerivativesAtTheRim) {
  const double h = 1e-4;
  EXPECT_NEAR((falloff(1 + h) - falloff(1 - h)) / (2 * h), 0, 1e-6);
  EXPECT_NEAR((falloff(1 + h) - 2 * falloff(1) + falloff(1 - h)) / (h * h), 0, 1e-3);
}

TEST(PatchGrid, WeightsAreTheFalloffOfSampleCentres) {
  const PatchGrid grid = make_patch_grid(8);
  ASSERT_EQ(grid.weights.size(), 64u);
  EXPECT_EQ(grid.pitch, 4);
  // The innermost sample is (1/2, 1/2) cells from the centre: r^2 = 1/32; the corner's disc does not reach it.
  EXPECT_FLOAT_EQ(grid.weights[3 * 8 + 3], static_cast<float>(std::pow(31.0 / 32, 3)));
  EXPECT_EQ(grid.weights[0], 0);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(grid.weights[y * 8 + x], grid.weights[x * 8 + y]);
      EXPECT_EQ(grid.weights[y * 8 + x], grid.weights[y * 8 + 7 - x]);
    }
}

TEST(PatchGrid, CoversAtLeastHalfAtPitchR) {
  for (int m = 4; m <= 64; m += 2) EXPECT_GE(minimum_cover(make_patch_grid(m)), 0.5 - 1e-6) << m;
  // Where R is odd a sample lies where four discs are equally far: 4 g(1/sqrt 2) = 1/2.
  EXPECT_NEAR(minimum_cover(make_patch_grid(6)), 0.5, 1e-6);
}

TEST(PatchGrid, EveryCellHasTheSameSumOfWeightsToTheBorder) {
  for (const auto& [m, pitch] : {std::pair{8, 4}, {8, 3}, {6, 2}, {16, 8}, {4, 1}}) {
    const PatchGrid grid = make_patch_grid(m, pitch);
    const int cells = 29;
    std::vector<double> cover(cells * cells, 0.0);
    for (std::int64_t j = 0; j < patches_along(grid, cells); ++j)
      for (std::int64_t i = 0; i < patches_along(grid, cells); ++i)
        for (int y = 0; y < m; ++y)
          for (int x = 0; x < m; ++x) {
            const std::int64_t cx = patch_origin(grid, i) + x, cy = patch_origin(grid, j) + y;
            if (cx >= 0 && cx < cells && cy >= 0 && cy < cells) cover[cy * cells + cx] += grid.weights[y * m + x];
          }
    const double least = minimum_cover(grid);
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        EXPECT_GE(cover[y * cells + x], least - 1e-9);
        if (x >= pitch && y >= pitch) {
          EXPECT_NEAR(cover[y * cells + x], cover[(y - pitch) * cells + x - pitch], 1e-9);
        }
      }
  }
}

TEST(PatchGrid, TouchingPatchesAreThoseThatOverlapTheCells) {
  const PatchGrid grid = make_patch_grid(8, 3);
  for (std::int64_t begin = -20; begin < 20; ++begin)
    for (std::int64_t end = begin + 1; end < begin + 12; ++end) {
      const PatchRange range = patches_touching(grid, begin, end);
      for (std::int64_t k = -30; k < 30; ++k) {
        const bool touches = patch_origin(grid, k) < end && patch_origin(grid, k) + 8 > begin;
        EXPECT_EQ(touches, k >= range.begin && k < range.end) << begin << ' ' << end << ' ' << k;
      }
    }
  EXPECT_EQ(patches_touching(grid, 5, 5).count(), 0);
}

TEST(PatchGrid, RefusesWhatLeavesHoles) {
  EXPECT_THROW(make_patch_grid(7), Error);
  EXPECT_THROW(make_patch_grid(0), Error);
  EXPECT_THROW(make_patch_grid(8, 9), Error);
  EXPECT_THROW(make_patch_grid(8, 8), Error);   // discs that only touch
  EXPECT_NO_THROW(make_patch_grid(8, 5));
}

}  // namespace
}  // namespace arete
