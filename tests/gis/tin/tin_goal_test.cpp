#include "gis/tin/tin_goal.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/error.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

using testing::HasSubstr;

TEST(MakeTinOfTriangles, MeetsTheNumberToAPercent) {
  NoProgress silent;
  const HeldRaster raster(noisy_waves(200, 150, 5));
  for (const std::int64_t most : {100, 1000, 5000, 20000}) {
    const TinReport report = make_tin_of_triangles(raster, most, {}, silent).report;
    EXPECT_LE(report.triangles, most);
    EXPECT_GE(static_cast<double>(report.triangles), 0.99 * static_cast<double>(most));
    EXPECT_LE(report.max_error_m, report.bound_m);
  }
}

TEST(MakeTinOfTriangles, WholeMetresDoNotJump) {
  Raster<float> cells = noisy_waves(300, 200, 4);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = std::round(cells.data()[i]);
  NoProgress silent;
  const HeldRaster raster(std::move(cells));
  TinOptions at_a_metre, below;
  at_a_metre.max_error_m = 1;
  below.max_error_m = 0.99;
  const std::int64_t few = make_tin(raster, at_a_metre, silent).report.triangles, many = make_tin(raster, below, silent).report.triangles;
  ASSERT_GT(static_cast<double>(many), 1.02 * static_cast<double>(few));  // a jump
  const std::int64_t most = (few + many) / 2;
  const TinReport report = make_tin_of_triangles(raster, most, {}, silent).report;
  EXPECT_LE(report.triangles, most);
  EXPECT_GE(static_cast<double>(report.triangles), 0.99 * static_cast<double>(most));
}

TEST(MakeTinOfTriangles, SaysHowManyAreNeeded) {
  NoProgress silent;
  Raster<float> cells(50, 40, 5.0f);
  cells(20, 20) = void_value;  // a hole of four corners needs eight triangles
  const HeldRaster raster(std::move(cells));
  try {
    make_tin_of_triangles(raster, 7, {}, silent);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("needs 8 triangles at least"));
  }
  EXPECT_EQ(make_tin_of_triangles(raster, 8, {}, silent).report.triangles, 8);
  EXPECT_THROW(make_tin_of_triangles(HeldRaster(noisy_waves(50, 40, 1)), 1, {}, silent), Error);
}

TEST(MakeTinOfTriangles, MoreThanTheGridHasAreNotNeeded) {
  NoProgress silent;
  const TinReport report = make_tin_of_triangles(HeldRaster(noisy_waves(30, 20, 5)), 100000, {}, silent).report;
  EXPECT_LE(report.triangles, 100000);
  EXPECT_LT(report.max_error_m, 0.01);
}

TEST(MakeTinOfRmse, MeetsIt) {
  NoProgress silent;
  const HeldRaster raster(noisy_waves(200, 150, 5));
  for (const double most : {0.5, 2.0, 10.0}) {
    const TinReport report = make_tin_of_rmse(raster, most, {}, silent).report;
    EXPECT_LE(report.rmse_m, most);
    EXPECT_GE(report.rmse_m, 0.98 * most);
  }
}

}  // namespace
}  // namespace arete
