#include "core/tree/tree_cells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/error.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

Raster<double> with_voids() {
  Raster<double> cells(30, 20, 100);
  for (std::int64_t x = 0; x < 30; ++x) cells(x, 7) = static_cast<double>(x);
  cells(4, 4) = cells(5, 4) = std::nan("");
  return cells;
}

TEST(TreeCells, CountsAndMeasures) {
  TreeHeader header;
  header.scale = -0.5;
  header.geo.metres_per_unit = 2;
  const TreeCells cells = read_tree_cells(MemoryStored(with_voids()), header);
  EXPECT_EQ(cells.valid, 598);
  EXPECT_TRUE(cells.any_void);
  EXPECT_EQ(cells.voids.cells(4, 4), 1);
  EXPECT_EQ(cells.lowest, 0);
  EXPECT_EQ(cells.highest, 100);
  EXPECT_EQ(cells.metres_per_stored, 1);
  EXPECT_THROW(read_tree_cells(MemoryStored(Raster<double>(3, 3, std::nan(""))), header), Error);
}

TEST(TreeCells, FillsOnlyTheVoids) {
  const TreeCells cells = read_tree_cells(MemoryStored(with_voids()), TreeHeader());
  const Raster<float> filled = fill_cells(cells);
  for (std::int64_t i = 0; i < 600; ++i) {
    if (std::isnan(cells.stored.data()[i]))
      EXPECT_NEAR(filled.data()[i], 100, 20);
    else
      EXPECT_EQ(filled.data()[i], static_cast<float>(cells.stored.data()[i]));
  }
}

TEST(TreeCells, MasksAreThereOnlyWithVoids) {
  const NodeGrid grid({30, 20}, 32);
  EXPECT_FALSE(encode_masks(read_tree_cells(MemoryStored(with_voids()), TreeHeader()), grid, 1).root.empty());
  EXPECT_TRUE(encode_masks(read_tree_cells(MemoryStored(Raster<double>(30, 20, 5)), TreeHeader()), grid, 1).root.empty());
}

}  // namespace
}  // namespace arete
