#include "core/codec/predict_planes.h"

#include <gtest/gtest.h>

#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

PredictParameters any_range() {
  PredictParameters file;
  file.lowest = -100000;
  file.highest = 100000;
  return file;
}

LevelView view_of(const Raster<std::int32_t>& level) { return {level.view(), {}, 0, 0, level.size()}; }

TEST(PredictPlanes, TheLatticeContinuesAPlaneBeyondTheBorder) {
  Raster<std::int32_t> level(20, 17);
  for (std::int64_t y = 0; y < 17; ++y)
    for (std::int64_t x = 0; x < 20; ++x) level(x, y) = static_cast<std::int32_t>(7 * x - 3 * y);
  const NodePlanes planes = make_planes(view_of(level), {0, 0, 40, 33}, {}, any_range());
  ASSERT_EQ(planes.width, 20);
  ASSERT_EQ(planes.height, 17);
  for (int y = -8; y < 17 + 8; ++y)
    for (int x = -8; x < 20 + 8; ++x) ASSERT_EQ(planes.values[0].row(y)[x], 7 * x - 3 * y) << x << "," << y;
}

TEST(PredictPlanes, TheExtensionIsHeldToTheRange) {
  Raster<std::int32_t> level(9, 9);
  for (std::int64_t y = 0; y < 9; ++y)
    for (std::int64_t x = 0; x < 9; ++x) level(x, y) = static_cast<std::int32_t>(100 * x);
  PredictParameters file;
  file.lowest = 0;
  file.highest = 800;
  const NodePlanes planes = make_planes(view_of(level), {0, 0, 18, 18}, {}, file);
  EXPECT_EQ(planes.values[0].row(4)[-3], 0);
  EXPECT_EQ(planes.values[0].row(4)[12], 800);
}

TEST(PredictPlanes, ABlockComesBackFromItsPhases) {
  const Raster<std::int32_t> level = fractal_terrain(10, 9, 500), fine = fractal_terrain(19, 18, 500);
  NodePlanes planes = make_planes(view_of(level), {0, 0, 19, 18}, {}, any_range());
  for (int p = 0; p < 4; ++p)
    for (int y = 0; y < coded_height(planes, p); ++y)
      for (int x = 0; x < coded_width(planes, p); ++x) planes.values[static_cast<std::size_t>(p)].row(y)[x] = fine(2 * x + odd_x(p), 2 * y + odd_y(p));
  Raster<std::int32_t> out(19, 18, -1);
  copy_block(planes, out.view());
  EXPECT_EQ(largest_difference(out.view(), fine.view()), 0);
}

TEST(PredictPlanes, VoidCellsTakeTheMeanOfTheirValidNeighbours) {
  Raster<std::int32_t> level(12, 12, 50);
  Raster<std::uint8_t> voids(12, 12, 0);
  level(5, 5) = 999999;  // under a void: must not show
  voids(5, 5) = 1;
  level(4, 4) = 58;
  LevelView view = view_of(level);
  view.voids = voids.view();
  const NodePlanes planes = make_planes(view, {0, 0, 24, 24}, {}, any_range());
  EXPECT_EQ(planes.values[0].row(5)[5], 51);  // (7 * 50 + 58) / 8
  EXPECT_EQ(planes.voids[0].row(5)[5], 1);
  EXPECT_EQ(planes.voids[0].row(4)[5], 0);
}

TEST(PredictPlanes, MeansBelowZeroRoundDown) {
  Raster<std::int32_t> level(12, 12, -50);
  Raster<std::uint8_t> voids(12, 12, 0);
  voids(5, 5) = 1;
  level(4, 4) = -51;
  LevelView view = view_of(level);
  view.voids = voids.view();
  EXPECT_EQ(make_planes(view, {0, 0, 24, 24}, {}, any_range()).values[0].row(5)[5], -51);  // floor(-401 / 8)
}

}  // namespace
}  // namespace arete
