#include "gis/tin/drape_lines.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace arete {
namespace {

const std::vector<std::int64_t> columns{0, 20, 40}, rows{0, 30};

Raster<float> waves() {
  Raster<float> dem(41, 31);
  for (std::int64_t y = 0; y < 31; ++y)
    for (std::int64_t x = 0; x < 41; ++x) dem(x, y) = static_cast<float>(50 * std::sin(static_cast<double>(x) / 4));
  return dem;
}

TEST(DrapeLines, StayWithinTheErrorOfTheSurface) {
  const Raster<float> dem = waves();
  const TinLines lines{{{{1.3, 2.2}, {38.4, 27.9}}}, {}};
  for (const double error : {0.5, 4.0}) {
    const RasterLine line = drape_lines(ViewSource(dem.view()), lines, columns, rows, error).breaklines.at(0);
    ASSERT_GT(line.size(), 4u);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const RasterPlace &a = line[i - 1], &b = line[i];
      if ((a[0] < 20) != (b[0] < 20)) continue;  // a vertex is made at the border of tiles between
      for (double t = 0; t <= 1; t += 0.01) {
        const double surface = height_between(dem.view(), a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
        const double straight = height_between(dem.view(), a[0], a[1]) * (1 - t) + height_between(dem.view(), b[0], b[1]) * t;
        EXPECT_LE(std::abs(surface - straight), error + 0.4) << "the samples lie half a cell apart, over which a wave rises by 0.4 m off straight";
      }
    }
  }
}

TEST(DrapeLines, AddsNothingToWhatIsStraight) {
  Raster<float> plane(41, 31);
  for (std::int64_t y = 0; y < 31; ++y)
    for (std::int64_t x = 0; x < 41; ++x) plane(x, y) = static_cast<float>(3 * x - y);
  const TinLines lines{{{{-5, 2.2}, {60, 27.9}}, {{1, 1}}, {}}, {{{2, 2}, {9, 2}, {5, 9}, {2, 2}}}};
  const TinLines draped = drape_lines(ViewSource(plane.view()), lines, columns, rows, 1e-3);
  EXPECT_EQ(draped.breaklines, lines.breaklines);
  EXPECT_EQ(draped.boundary, lines.boundary);
}

TEST(HeightBetween, IsOfValidCellsAlone) {
  Raster<float> dem(3, 2);
  for (std::int64_t x = 0; x < 3; ++x) dem(x, 0) = static_cast<float>(10 * x), dem(x, 1) = static_cast<float>(10 * x + 4);
  EXPECT_EQ(height_between(dem.view(), 1.5, 0.5), 17);
  EXPECT_EQ(height_between(dem.view(), 2, 1), 24);
  dem(1, 0) = dem(1, 1) = void_value;
  EXPECT_EQ(height_between(dem.view(), 1.5, 0), 20);
  EXPECT_TRUE(std::isnan(height_between(dem.view(), 1, 1)));
}

}  // namespace
}  // namespace arete
