#include "gis/tin/displaced_errors.h"

#include <gtest/gtest.h>

#include "core/terrain/raster.h"

namespace arete {
namespace {

/// In half cells: a flat triangle, and beside its side at 2.5 cells one that rises by 10 m a cell.
TileMesh flat_beside_steep() {
  TileMesh mesh;
  add_vertex(mesh, 5, 2, 0, false);
  add_vertex(mesh, 5, 14, 0, false);
  add_vertex(mesh, 2, 8, 0, false);
  add_vertex(mesh, 11, 8, 30, false);
  mesh.origin = {0, 1, 2, 1, 0, 3};
  mesh.twin = {3, -1, -1, 0, -1, -1};
  return mesh;
}

Raster<float> rising_cells() {
  Raster<float> cells(9, 9);
  for (std::int64_t y = 0; y < 9; ++y)
    for (std::int64_t x = 0; x < 9; ++x) cells(x, y) = x < 3 ? 0.0F : static_cast<float>(10 * (static_cast<double>(x) - 2.5));
  return cells;
}

TEST(DisplacedErrors, ATriangleAnswersForTheCellsCloseBesideIt) {
  const TileMesh mesh = flat_beside_steep();
  const Raster<float> cells = rising_cells();
  TileBound bound;
  bound.error_m = 7;
  bound.displacement.rounding_cells = 0.4;  // slopes make 4 m of it, and no cell of the flat triangle is within 0.4 cells of the steep one
  EXPECT_TRUE(find_displaced_excesses(mesh, cells.view(), bound).empty());
  bound.displacement.rounding_cells = 0.55;  // now they are, 5 m off its plane: with the slope's 5.5 m, 3.5 m beyond
  const std::vector<DisplacedExcess> beyond = find_displaced_excesses(mesh, cells.view(), bound);
  ASSERT_EQ(beyond.size(), 1U);
  EXPECT_EQ(beyond[0].triangle, 1);
  EXPECT_NEAR(beyond[0].beyond_m, 3.5, 1e-9);
  EXPECT_FALSE(beyond[0].on_side);
  bound.error_m = 10.51;
  EXPECT_TRUE(find_displaced_excesses(mesh, cells.view(), bound).empty());
}

TEST(DisplacedErrors, CellsOnTheSidesCountAndVoidsDoNot) {
  TileMesh mesh = flat_beside_steep();
  for (std::int32_t& x : mesh.x) x -= 2;  // the flat triangle's corner lies on the left side of the tile, at (0, 4)
  Raster<float> cells(9, 9, void_value);
  TileBound bound;
  bound.error_m = 1;
  bound.displacement.rounding_cells = 0.01;
  EXPECT_TRUE(find_displaced_excesses(mesh, cells.view(), bound).empty());
  cells(0, 4) = 3;
  const std::vector<DisplacedExcess> beyond = find_displaced_excesses(mesh, cells.view(), bound);
  ASSERT_EQ(beyond.size(), 1U);
  EXPECT_EQ(beyond[0].triangle, 0);
  EXPECT_NEAR(beyond[0].beyond_m, 2, 1e-9);
  EXPECT_TRUE(beyond[0].on_side);
}

TEST(DisplacedErrors, BesideABoundaryCellsThatNoTriangleCoversAreLeftOut) {
  TileMesh mesh = flat_beside_steep();
  Raster<float> cells = rising_cells();
  mesh.origin.resize(3), mesh.twin = {-1, -1, -1};  // the flat triangle alone, its side at 2.5 cells the boundary
  TileBound bound;
  bound.error_m = 1;
  bound.displacement.rounding_cells = 0.6;
  EXPECT_EQ(find_displaced_excesses(mesh, cells.view(), bound).size(), 1U) << "a cell at 3 is 5 m up";
  for (auto* places : {&mesh.x, &mesh.y})
    for (std::int32_t& place : *places) place *= 2;
  mesh.units = 4;
  EXPECT_TRUE(find_displaced_excesses(mesh, cells.view(), bound).empty());
}

}  // namespace
}  // namespace arete
