#include "core/terrain/sea.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(FindSea, TakesFlatCellsAtOrBelowZeroAndTheirShore) {
  Raster<float> cells(12, 9, 5);
  for (std::int64_t y = 2; y < 6; ++y)
    for (std::int64_t x = 1; x < 6; ++x) cells(x, y) = 0;
  cells(6, 3) = 0;                               // beside flat cells, but beside land on three sides: no neighbour of a flat one
  for (std::int64_t y = 0; y < 9; ++y) cells(9, y) = -3;  // a trench one cell wide
  const Raster<std::uint8_t> sea = find_sea(cells.view());
  for (std::int64_t y = 0; y < 9; ++y)
    for (std::int64_t x = 0; x < 12; ++x) EXPECT_EQ(sea(x, y), x >= 1 && x < 6 && y >= 2 && y < 6) << x << ", " << y;
}

TEST(FindSea, LandThatIsFlatIsNoneNorIsAVoidAndTheBorderIsNoShore) {
  Raster<float> cells(8, 8, 10);
  for (const std::uint8_t wet : {find_sea(cells.view())(3, 3), find_sea(cells.view())(0, 0)}) EXPECT_EQ(wet, 0);
  for (std::int64_t i = 0; i < 64; ++i) cells.data()[i] = -1;
  EXPECT_EQ(find_sea(cells.view())(0, 0), 1);
  cells(4, 4) = void_value;
  const Raster<std::uint8_t> sea = find_sea(cells.view());
  EXPECT_EQ(sea(4, 4), 0);
  EXPECT_EQ(sea(3, 3), 1);  // beside (2, 2), which is flat
}

}  // namespace
}  // namespace arete
