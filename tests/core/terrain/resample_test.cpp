#include "core/terrain/resample.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

Raster<float> ramp(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = 3.0f * static_cast<float>(x) - 2.0f * static_cast<float>(y);
  return cells;
}

TEST(AreaAverage, IsTheMeanOfEachBlockAndDropsTheRest) {
  const Raster<float> coarse = area_average(ramp(9, 7).view(), 4);
  EXPECT_EQ(coarse.size(), (Size{2, 1}));
  EXPECT_FLOAT_EQ(coarse(1, 0), 3 * 5.5f - 2 * 1.5f);
}

TEST(AreaAverage, AVoidCellVoidsItsBlockOnly) {
  Raster<float> fine = ramp(8, 4);
  fine(1, 1) = void_value;
  const Raster<float> coarse = area_average(fine.view(), 4);
  EXPECT_TRUE(is_void(coarse(0, 0)));
  EXPECT_FALSE(is_void(coarse(1, 0)));
}

TEST(UpsampleBicubic, KeepsAPlaneAwayFromTheBorder) {
  const Raster<float> fine = upsample_bicubic(ramp(8, 8).view(), 4);
  for (std::int64_t y = 8; y < 24; ++y)
    for (std::int64_t x = 8; x < 24; ++x)
      EXPECT_NEAR(fine(x, y), 3 * ((static_cast<double>(x) + 0.5) / 4 - 0.5) - 2 * ((static_cast<double>(y) + 0.5) / 4 - 0.5), 1e-5);
}

TEST(UpsampleBicubic, VoidsKeepTheirCellsAndContaminateNothing) {
  Raster<float> coarse(6, 6, 100.0f);
  coarse(3, 3) = void_value;
  const Raster<float> fine = upsample_bicubic(coarse.view(), 2);
  for (std::int64_t y = 0; y < 12; ++y)
    for (std::int64_t x = 0; x < 12; ++x) {
      if (x / 2 == 3 && y / 2 == 3)
        EXPECT_TRUE(is_void(fine(x, y)));
      else
        EXPECT_FLOAT_EQ(fine(x, y), 100.0f);
    }
}

}  // namespace
}  // namespace arete
