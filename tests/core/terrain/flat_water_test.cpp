#include "core/terrain/flat_water.h"

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

/// No two neighbours are equal.
Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = static_cast<float>(100 + 7 * ((x + 2 * y) % 5) + x % 2);
  return cells;
}

void level(Raster<float>& cells, const Window& window, float z) {
  for (std::int64_t y = window.y; y < window.y + window.height; ++y)
    for (std::int64_t x = window.x; x < window.x + window.width; ++x) cells(x, y) = z;
}

std::int64_t count(const Raster<std::uint8_t>& water) {
  std::int64_t cells = 0;
  for (std::int64_t i = 0; i < water.size().cells(); ++i) cells += water.data()[i];
  return cells;
}

/// The definition, word for word: a cell of some square of side x side equal cells.
bool in_level_square(const Raster<float>& cells, std::int64_t x, std::int64_t y) {
  for (std::int64_t y0 = y - flat_water_side + 1; y0 <= y; ++y0)
    for (std::int64_t x0 = x - flat_water_side + 1; x0 <= x; ++x0) {
      if (x0 < 0 || y0 < 0 || x0 + flat_water_side > cells.width() || y0 + flat_water_side > cells.height()) continue;
      bool equal = true;
      for (std::int64_t j = y0; j < y0 + flat_water_side; ++j)
        for (std::int64_t i = x0; i < x0 + flat_water_side; ++i) equal = equal && cells(i, j) == cells(x0, y0);
      if (equal) return true;
    }
  return false;
}

/// The definition, plainly: squares, then as many steps as allowed into equal neighbours.
Raster<std::uint8_t> grow_squares(const Raster<float>& cells) {
  Raster<std::uint8_t> water(cells.width(), cells.height());
  for (std::int64_t y = 0; y < cells.height(); ++y)
    for (std::int64_t x = 0; x < cells.width(); ++x) water(x, y) = in_level_square(cells, x, y) ? 1 : 0;
  for (int step = 0; step < flat_water_growth; ++step) {
    const Raster<std::uint8_t> before = water.clone();
    for (std::int64_t y = 0; y < cells.height(); ++y)
      for (std::int64_t x = 0; x < cells.width(); ++x) {
        const auto joins = [&](std::int64_t i, std::int64_t j) {
          return i >= 0 && j >= 0 && i < cells.width() && j < cells.height() && before(i, j) && cells(i, j) == cells(x, y);
        };
        if (joins(x - 1, y) || joins(x + 1, y) || joins(x, y - 1) || joins(x, y + 1)) water(x, y) = 1;
      }
  }
  return water;
}

TEST(FlatWater, IsTheDefinitionOnRandomTerrainOfFewHeights) {
  Raster<float> cells(60, 50);
  for (std::int64_t y = 0; y < 50; ++y)
    for (std::int64_t x = 0; x < 60; ++x)
      cells(x, y) = uniform_at(1, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) < 0.04 ? 1.0f : 0.0f;
  for (std::int64_t i = 0; i < 40; ++i) cells(i, 20) = void_value;
  const Raster<std::uint8_t> water = find_flat_water(cells.view()), expected = grow_squares(cells);
  for (std::int64_t y = 0; y < 50; ++y)
    for (std::int64_t x = 0; x < 60; ++x) EXPECT_EQ(water(x, y), expected(x, y)) << x << ", " << y;
  EXPECT_GT(count(water), 100);
}

TEST(FlatWater, ASquareOfFiveCountsAndOneOfFourDoesNot) {
  Raster<float> cells = rough(30, 20);
  level(cells, {3, 3, 5, 5}, 0);
  level(cells, {15, 3, 4, 12}, 0);
  const Raster<std::uint8_t> water = find_flat_water(cells.view());
  EXPECT_EQ(count(water), 25);
  EXPECT_EQ(water(3, 3), 1);
  EXPECT_EQ(water(7, 7), 1);
  EXPECT_EQ(water(8, 7), 0);
  EXPECT_EQ(water(16, 8), 0);
}

TEST(FlatWater, EqualNeighboursOnAPlainOfWholeMetresAreNoWater) {
  Raster<float> cells(40, 40);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 40; ++x) cells(x, y) = static_cast<float>((x + y) / 4);  // steps four cells wide
  EXPECT_EQ(count(find_flat_water(cells.view())), 0);
}

TEST(FlatWater, TwoLakesOfDifferentLevelsBothCountButNoSquareAcrossThem) {
  Raster<float> cells = rough(20, 12);
  level(cells, {2, 2, 5, 6}, 10);
  level(cells, {7, 2, 3, 6}, 11);
  EXPECT_EQ(count(find_flat_water(cells.view())), 30);
}

TEST(FlatWater, ReachesIntoANarrowChannelButNotForEver) {
  Raster<float> cells = rough(30, 12);
  level(cells, {0, 2, 5, 6}, 0);
  level(cells, {5, 4, 20, 1}, 0);
  EXPECT_EQ(count(find_flat_water(cells.view())), 30 + flat_water_growth);
}

TEST(FlatWater, VoidsAndASmallRasterHaveNone) {
  EXPECT_EQ(count(find_flat_water(Raster<float>(20, 20, void_value).view())), 0);
  EXPECT_EQ(count(find_flat_water(Raster<float>(4, 20, 0.0f).view())), 0);
  EXPECT_EQ(count(find_flat_water(Raster<float>(5, 5, 0.0f).view())), 25);
}

TEST(FlatWater, ACellDependsOnFourCellsAroundIt) {
  Raster<float> cells(40, 40, 0.0f);
  const Raster<std::uint8_t> before = find_flat_water(cells.view());
  cells(20, 20) = 1;
  const Raster<std::uint8_t> after = find_flat_water(cells.view());
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 40; ++x)
      if (std::abs(x - 20) > 4 || std::abs(y - 20) > 4) {
        EXPECT_EQ(after(x, y), before(x, y));
      }
}

}  // namespace
}  // namespace arete
