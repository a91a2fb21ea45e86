#include "core/terrain/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "core/terrain/resample.h"

namespace arete {
namespace {

Raster<float> rough(std::int64_t width, std::int64_t height, std::uint64_t seed = 1) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(100 * uniform_at(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  return cells;
}

Raster<float> shifted(const Raster<float>& cells, float by) {
  Raster<float> moved = cells.clone();
  for (std::int64_t i = 0; i < moved.size().cells(); ++i) moved.data()[i] += by;
  return moved;
}

TEST(CompareTerrain, ARasterEqualsItself) {
  const Raster<float> cells = rough(30, 20);
  CompareOptions options;
  options.factor = 4;
  const Comparison c = compare_terrain(cells.view(), cells.view(), options);
  EXPECT_EQ(c.cells, 600);
  EXPECT_EQ(c.bias_m, 0);
  EXPECT_EQ(c.rmse_m, 0);
  EXPECT_EQ(c.max_m, 0);
  EXPECT_EQ(c.p99_m, 0);
  EXPECT_EQ(c.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_EQ(c.slope_rmse_deg, 0);
  EXPECT_EQ(c.aspect_rmse_deg, 0);
  EXPECT_EQ(c.consistency_m.value(), 0);
  EXPECT_EQ(c.wasserstein_m, 0);
  EXPECT_EQ(c.integral_reference, c.integral_result);
}

TEST(CompareTerrain, AShiftIsAllBias) {
  // Multiples of 1/8 keep every sum exact.
  Raster<float> cells(40, 25);
  for (std::int64_t i = 0; i < 1000; ++i) cells.data()[i] = static_cast<float>(i % 37) / 8;
  CompareOptions options;
  options.factor = 5;
  const Comparison c = compare_terrain(cells.view(), shifted(cells, 3).view(), options);
  EXPECT_EQ(c.bias_m, 3);
  EXPECT_EQ(c.rmse_m, 3);
  EXPECT_EQ(c.mae_m, 3);
  EXPECT_EQ(c.max_m, 3);
  EXPECT_EQ(c.max_x, 0);
  EXPECT_EQ(c.max_y, 0);
  EXPECT_EQ(c.p50_m, 3);
  EXPECT_EQ(c.p99_m, 3);
  EXPECT_EQ(c.peak_m, 4.5);
  EXPECT_DOUBLE_EQ(c.psnr_db, 20 * std::log10(1.5));
  EXPECT_EQ(c.slope_rmse_deg, 0);
  EXPECT_EQ(c.consistency_m.value(), 3);
  EXPECT_EQ(c.consistency_blocks, 40);
  EXPECT_NEAR(c.wasserstein_m, 3, 7.5 / 32768);
}

TEST(CompareTerrain, AgreesWithTheDefinitionsOnNoise) {
  const Raster<float> a = rough(50, 41, 1), b = rough(50, 41, 2);
  const Comparison c = compare_terrain(a.view(), b.view(), {});
  std::vector<double> magnitudes;
  std::vector<float> heights_a, heights_b;
  double square = 0, sum = 0;
  for (std::int64_t i = 0; i < 50 * 41; ++i) {
    const double error = static_cast<double>(b.data()[i]) - static_cast<double>(a.data()[i]);
    magnitudes.push_back(std::abs(error));
    heights_a.push_back(a.data()[i]), heights_b.push_back(b.data()[i]);
    square += error * error;
    sum += error;
  }
  std::sort(magnitudes.begin(), magnitudes.end());
  std::sort(heights_a.begin(), heights_a.end());
  std::sort(heights_b.begin(), heights_b.end());
  EXPECT_NEAR(c.bias_m, sum / 2050, 1e-12);
  EXPECT_NEAR(c.rmse_m, std::sqrt(square / 2050), 1e-12);
  EXPECT_NEAR(c.p90_m, magnitudes[1844], 5e-4 * magnitudes[1844]);  // the 1845th of 2050
  EXPECT_NEAR(c.p50_m, magnitudes[1024], 5e-4 * magnitudes[1024]);
  EXPECT_EQ(c.max_m, magnitudes.back());
  // On a line the optimal transport pairs the sorted heights.
  double transport = 0;
  for (std::size_t i = 0; i < 2050; ++i) transport += std::abs(static_cast<double>(heights_a[i]) - static_cast<double>(heights_b[i]));
  EXPECT_NEAR(c.wasserstein_m, transport / 2050, 100.0 / 32768);
}

TEST(CompareTerrain, ComparesOnlyCellsThatBothHave) {
  Raster<float> a = rough(20, 20), b = shifted(a, 1);
  a(3, 3) = void_value;
  b(10, 10) = b(11, 10) = void_value;
  b(3, 3) = 1e6f;  // must not be seen
  a(10, 10) = -500;  // counts for the peak only
  CompareOptions options;
  options.factor = 4;
  const Comparison c = compare_terrain(a.view(), b.view(), options);
  EXPECT_EQ(c.cells, 397);
  EXPECT_EQ(c.only_reference, 2);
  EXPECT_EQ(c.only_result, 1);
  EXPECT_NEAR(c.max_m, 1, 1e-5);
  EXPECT_GT(c.peak_m, 500);
  EXPECT_EQ(c.consistency_blocks, 23);
  EXPECT_EQ(c.slope_cells, 18 * 18 - 9 - 12);
  EXPECT_NEAR(c.slope_rmse_deg, 0, 1e-4);
}

TEST(CompareTerrain, TheBorderIsLeftOut) {
  const Raster<float> a = rough(20, 16);
  Raster<float> b = shifted(a, 2);
  for (std::int64_t x = 0; x < 20; ++x) b(x, 1) = 9999;
  CompareOptions options;
  options.border = 2;
  const Comparison c = compare_terrain(a.view(), b.view(), options);
  EXPECT_EQ(c.cells, 16 * 12);
  EXPECT_NEAR(c.max_m, 2, 1e-5);
  EXPECT_EQ(c.max_x, std::clamp<std::int64_t>(c.max_x, 2, 17));
}

TEST(CompareTerrain, SlopeAndAspectErrorsAreInDegrees) {
  Raster<float> a(10, 10), b(10, 10);
  for (std::int64_t y = 0; y < 10; ++y)
    for (std::int64_t x = 0; x < 10; ++x) {
      a(x, y) = static_cast<float>(-x);                                                    // 45 degrees, falls to the east
      b(x, y) = static_cast<float>(std::tan(M_PI / 6) * static_cast<double>(y));           // 30 degrees, falls to the north
    }
  const Comparison c = compare_terrain(a.view(), b.view(), {});
  EXPECT_NEAR(c.slope_rmse_deg, 15, 1e-5);
  EXPECT_NEAR(c.aspect_rmse_deg, 90, 1e-5);
}

TEST(CompareTerrain, AspectsWrapAtNorth) {
  Raster<float> a(8, 8), b(8, 8);
  for (std::int64_t y = 0; y < 8; ++y)
    for (std::int64_t x = 0; x < 8; ++x) {
      a(x, y) = static_cast<float>(static_cast<double>(y) - 0.1 * static_cast<double>(x));
      b(x, y) = static_cast<float>(static_cast<double>(y) + 0.1 * static_cast<double>(x));
    }
  EXPECT_NEAR(compare_terrain(a.view(), b.view(), {}).aspect_rmse_deg, 2 * std::atan(0.1) * 180 / M_PI, 1e-4);
}

TEST(CompareTerrain, ConsistencyIsTheErrorOfTheAreaAverages) {
  const Raster<float> a = rough(1100, 700, 3), b = rough(1100, 700, 4);
  CompareOptions options;
  options.factor = 7;
  const Comparison c = compare_terrain(a.view(), b.view(), options);
  const Comparison coarse = compare_terrain(area_average(a.view(), 7).view(), area_average(b.view(), 7).view(), {});
  EXPECT_EQ(c.consistency_blocks, coarse.cells);
  EXPECT_NEAR(c.consistency_m.value(), coarse.rmse_m, 1e-5);
}

TEST(CompareTerrain, IsTheSameForAnyThreadCount) {
  const Raster<float> a = rough(1100, 700, 3), b = rough(1100, 700, 4);
  CompareOptions one, many;
  one.threads = 1, many.threads = 5;
  const Comparison c = compare_terrain(a.view(), b.view(), one), d = compare_terrain(a.view(), b.view(), many);
  EXPECT_EQ(c.cells, 1100 * 700);
  EXPECT_EQ(c.slope_cells, 1098 * 698);
  EXPECT_EQ(c.rmse_m, d.rmse_m);
  EXPECT_EQ(c.slope_rmse_deg, d.slope_rmse_deg);
  EXPECT_EQ(c.wasserstein_m, d.wasserstein_m);
  EXPECT_EQ(c.max_x, d.max_x);
}

TEST(CompareTerrain, NothingInCommonGivesNoNumbersAndNoFailure) {
  const Raster<float> a(5, 5, void_value), b(5, 5, 1.0f);
  const Comparison c = compare_terrain(a.view(), b.view(), {});
  EXPECT_EQ(c.cells, 0);
  EXPECT_EQ(c.only_result, 25);
  EXPECT_TRUE(std::isnan(c.rmse_m));
  EXPECT_TRUE(std::isnan(c.psnr_db));
  EXPECT_TRUE(std::isnan(c.p50_m));
}

TEST(CompareTerrain, RefusesDifferentSizes) {
  try {
    compare_terrain(Raster<float>(5, 5, 0.0f).view(), Raster<float>(5, 6, 0.0f).view(), {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
  }
}

}  // namespace
}  // namespace arete
