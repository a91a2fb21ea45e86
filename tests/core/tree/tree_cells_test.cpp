#include "core/tree/tree_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

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

const Scratch in_files{0, std::filesystem::temp_directory_path().string()};

TEST(TreeCells, CountsAndMeasures) {
  TreeHeader header;
  header.scale = -0.5;
  header.geo.metres_per_unit = 2;
  const MemoryStored source(with_voids());
  for (const Scratch& scratch : {Scratch{}, in_files}) {
    const TreeCells cells = read_tree_cells(source, header, scratch);
    EXPECT_EQ(cells.valid, 598);
    EXPECT_TRUE(cells.any_void);
    EXPECT_EQ(cells.range.lowest, 0);
    EXPECT_EQ(cells.range.highest, 100);
    EXPECT_EQ(cells.metres_per_stored, 1);
  }
  EXPECT_THROW(read_tree_cells(MemoryStored(Raster<double>(3, 3, std::nan(""))), header, {}), Error);
}

TEST(TreeCells, FillsOnlyTheVoids) {
  const MemoryStored source(with_voids());
  const TreeCells cells = read_tree_cells(source, {}, {});
  for (const Scratch& scratch : {Scratch{}, in_files}) {
    const Raster<float> filled = read_all(FilledCells(cells, scratch, 1));
    for (std::int64_t i = 0; i < 600; ++i) {
      if (std::isnan(source.cells().data()[i]))
        EXPECT_NEAR(filled.data()[i], 100, 20);
      else
        EXPECT_EQ(filled.data()[i], static_cast<float>(source.cells().data()[i]));
    }
  }
}

// Wide enough to be filled in tiles: a hole over the border of two, and a tile that is void altogether.
TEST(TreeCells, FillsWideRastersInTiles) {
  Raster<double> stored(4200, 12);
  for (std::int64_t y = 0; y < 12; ++y)
    for (std::int64_t x = 0; x < 4200; ++x)
      stored(x, y) = (x > 1000 && x < 1050 && y > 3) || x > 2500 ? std::nan("") : 0.25 * static_cast<double>(x);
  const MemoryStored source(std::move(stored));
  const TreeCells cells = read_tree_cells(source, {}, {});
  const Raster<float> filled = read_all(FilledCells(cells, {}, 2));
  for (std::int64_t x = 1001; x < 1050; ++x) EXPECT_NEAR(filled(x, 8), 0.25 * static_cast<double>(x), 8) << x;
  for (std::int64_t i = 0; i < filled.size().cells(); ++i) ASSERT_FALSE(std::isnan(filled.data()[i])) << i;
  const Raster<float> again = read_all(FilledCells(cells, in_files, 1));
  EXPECT_TRUE(std::equal(filled.data(), filled.data() + filled.size().cells(), again.data()));
}

TEST(TreeCells, MapsWhatIsValidAndMarksTheRest) {
  const MemoryStored source(with_voids());
  const TreeCells cells = read_tree_cells(source, {}, {});
  const MappedCells mapped(cells, {ValueMap::Kind::steps, ValueType::int16, 50, 1, 2});
  Raster<std::int32_t> values(4, 3);
  Raster<std::uint8_t> voids(4, 3);
  mapped.read({3, 4, 4, 3}, values.view(), voids.view());
  EXPECT_EQ(values(0, 0), 150);
  EXPECT_EQ(voids(0, 0), 0);
  EXPECT_EQ(voids(1, 0), 1);
}

TEST(TreeCells, MasksAreThereOnlyWithVoids) {
  const NodeGrid grid({30, 20}, 32);
  const MemoryStored holes(with_voids()), full(Raster<double>(30, 20, 5));
  const MaskStreams masks = encode_masks(read_tree_cells(holes, {}, {}), grid, {}, 1);
  EXPECT_FALSE(masks.root.empty());
  EXPECT_EQ(encode_masks(read_tree_cells(holes, {}, {}), grid, in_files, 2).nodes, masks.nodes);
  EXPECT_TRUE(encode_masks(read_tree_cells(full, {}, {}), grid, {}, 1).root.empty());
}

}  // namespace
}  // namespace arete
