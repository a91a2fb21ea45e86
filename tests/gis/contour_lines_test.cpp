#include "gis/contour_lines.h"

#include <gtest/gtest.h>

#include <cmath>

namespace arete {
namespace {

constexpr Colour paper = {240, 240, 240, 255};

Picture contours_of(const Raster<float>& cells, Size pixels, double interval_m, int threads = 0) {
  const Raster<std::uint8_t> bare(cells.width(), cells.height(), 0);
  Picture map(pixels.width, pixels.height, paper);
  draw_contours(map, cells.view(), bare.view(), interval_m, threads);
  return map;
}

/// 2 m up per cell to the east, 1 m per cell to the south: centre of cell (0, 0) at 101 m.
Raster<float> plane(Size size) {
  Raster<float> cells(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) cells(x, y) = static_cast<float>(101 + 2 * x + y);
  return cells;
}

TEST(DrawContours, DarkPixelsLieAtTheMultiplesOfTheInterval) {
  const Raster<float> cells = plane({100, 80});
  for (const std::int64_t scale : {1, 4}) {
    const Picture map = contours_of(cells, {100 * scale, 80 * scale}, 40);
    const double change = std::hypot(2, 1) / static_cast<double>(scale);  // metres from pixel to pixel
    for (std::int64_t y = scale; y < map.height() - scale; ++y)
      for (std::int64_t x = scale; x < map.width() - scale; ++x) {
        const double column = (static_cast<double>(x) + 0.5) / static_cast<double>(scale) - 0.5,
                     row = (static_cast<double>(y) + 0.5) / static_cast<double>(scale) - 0.5;
        const double height = 101 + 2 * column + row, pixels = std::abs(height - 40 * std::round(height / 40)) / change;
        const bool fifth = std::abs(std::remainder(40 * std::round(height / 40), 200)) < 1;
        if (pixels > (fifth ? 1.55 : 1.1)) {
          ASSERT_EQ(map(x, y), paper) << x << ", " << y;
        }
        if (pixels < (fifth ? 0.4 : 0.05)) {
          ASSERT_LT(map(x, y)[0], 155) << x << ", " << y;
        }
      }
  }
}

TEST(DrawContours, LinesAreAsWideAtAnySlope) {
  for (const double rise : {0.5, 2.0, 8.0}) {
    Raster<float> cells(200, 20);
    for (std::int64_t y = 0; y < 20; ++y)
      for (std::int64_t x = 0; x < 200; ++x) cells(x, y) = static_cast<float>(rise * static_cast<double>(10 + x));
    // Lines at 60, 120 and 180 rises: no fifth.
    const Picture map = contours_of(cells, {200, 20}, 60 * rise);
    double covered = 0;
    for (std::int64_t x = 0; x < 200; ++x) covered += (240 - map(x, 10)[0]) / (0.62 * (240 - 82));
    EXPECT_NEAR(covered, 3, 0.1) << rise;
  }
}

TEST(DrawContours, TheyFadeWhereTheyWouldBeDense) {
  const Raster<float> cells = plane({60, 60});
  // 2.2 m from pixel to pixel: lines every 5 m would be 2.2 pixels apart; the fifths, 11, stay.
  const Picture map = contours_of(cells, {60, 60}, 5), gone = contours_of(cells, {60, 60}, 1);
  EXPECT_EQ(map(14, 1), paper);  // 130 m
  EXPECT_NE(map(12, 0), paper);  // 125 m
  for (std::int64_t i = 0; i < 60 * 60; ++i) ASSERT_EQ(gone.data()[i], paper);
}

TEST(DrawContours, LevelGroundWaterAndVoidsHaveNone) {
  Raster<float> cells = plane({60, 60});
  Raster<std::uint8_t> bare(60, 60, 0);
  for (std::int64_t y = 20; y < 40; ++y)
    for (std::int64_t x = 0; x < 60; ++x) {
      if (x < 20)
        cells(x, y) = 120;
      else if (x < 40)
        cells(x, y) = void_value;
      else
        bare(x, y) = 1;
    }
  Picture map(60, 60, paper);
  draw_contours(map, cells.view(), bare.view(), 20);
  for (std::int64_t y = 21; y < 39; ++y)
    for (std::int64_t x = 0; x < 60; ++x)
      if (x != 19 && x != 20 && x != 39 && x != 40) {
        ASSERT_EQ(map(x, y), paper) << x << ", " << y;
      }
  std::int64_t dark = 0;
  for (std::int64_t i = 0; i < 60 * 60; ++i) dark += map.data()[i][0] < 200;
  EXPECT_GT(dark, 60);
}

TEST(DrawContours, ACornerThatIsLevelAtAMultipleHasNoSpot) {
  // 101 m in the first cell's centre, and so in its outer quarter.
  const Picture map = contours_of(plane({12, 10}), {12 * 16, 10 * 16}, 101);
  for (std::int64_t y = 0; y < 7; ++y)
    for (std::int64_t x = 0; x < 7; ++x) ASSERT_EQ(map(x, y), paper) << x << ", " << y;
}

TEST(DrawContours, TheSamePictureForAnyNumberOfThreadsAndForOneCell) {
  const Raster<float> cells = plane({50, 70});
  const Picture one = contours_of(cells, {150, 210}, 10, 1), four = contours_of(cells, {150, 210}, 10, 4);
  for (std::int64_t i = 0; i < 150 * 210; ++i) ASSERT_EQ(one.data()[i], four.data()[i]);
  const Picture cell = contours_of(Raster<float>(1, 1, 20.0f), {5, 5}, 20);
  EXPECT_EQ(cell(2, 2), paper);
}

}  // namespace
}  // namespace arete
