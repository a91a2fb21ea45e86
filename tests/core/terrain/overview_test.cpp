#include "core/terrain/overview.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t i = 0; i < width * height; ++i) cells.data()[i] = static_cast<float>(uniform_at(3, static_cast<std::uint64_t>(i)));
  return cells;
}

Overview overview_of(const Raster<float>& cells, std::int64_t across, std::int64_t down, int threads = 0) {
  NoProgress silent;
  return make_overview(ViewSource(cells.view()), across, down, threads, silent);
}

TEST(Overview, IsTheAreaAverage) {
  const Raster<float> cells = rough(1200, 800);
  const Raster<float> expected = area_average(cells.view(), 4);
  for (const int threads : {1, 3}) {
    const Overview overview = overview_of(cells, 4, 4, threads);
    ASSERT_EQ(overview.cells.size(), expected.size());
    EXPECT_EQ(std::memcmp(overview.cells.data(), expected.data(), 300 * 200 * sizeof(float)), 0);
    EXPECT_EQ(overview.valid, 1200 * 800);
  }
}

TEST(Overview, KeepsTheBlocksThatTheBorderCuts) {
  Raster<float> cells(7, 5);
  for (std::int64_t y = 0; y < 5; ++y)
    for (std::int64_t x = 0; x < 7; ++x) cells(x, y) = static_cast<float>(x + 10 * y);
  const Overview overview = overview_of(cells, 3, 2);
  EXPECT_EQ(overview.cells.size(), (Size{3, 3}));
  EXPECT_FLOAT_EQ(overview.cells(0, 0), 6);
  EXPECT_FLOAT_EQ(overview.cells(2, 2), 46);  // one cell is left of it
  EXPECT_EQ(overview.low_m, 0);
  EXPECT_EQ(overview.high_m, 46);
}

TEST(Overview, ABlockIsVoidWhenMostOfItIs) {
  Raster<float> cells(4, 2, 5.0f);
  cells(0, 0) = cells(1, 0) = void_value;                 // half of the first block
  cells(2, 0) = cells(3, 0) = cells(2, 1) = void_value;   // most of the second
  const Overview overview = overview_of(cells, 2, 2);
  EXPECT_EQ(overview.cells(0, 0), 5);
  EXPECT_TRUE(is_void(overview.cells(1, 0)));
  EXPECT_EQ(overview.valid, 3);
}

TEST(Overview, OfNothingButVoidsHasNoRange) {
  const Overview overview = overview_of(Raster<float>(3, 3, void_value), 1, 1);
  EXPECT_EQ(overview.valid, 0);
  EXPECT_TRUE(std::isnan(overview.low_m));
}

}  // namespace
}  // namespace arete
