#include "core/terrain/surface.h"

#include <gtest/gtest.h>

#include <cmath>

namespace arete {
namespace {

Raster<float> make(std::int64_t width, std::int64_t height, double (*f)(double, double)) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = static_cast<float>(f(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5));
  return cells;
}

// Keys's interpolation reproduces polynomials of degree 2.
TEST(Surface, ReproducesQuadraticsAndTheirDerivatives) {
  const Raster<float> cells = make(600, 300, [](double x, double y) { return 0.25 * x * x - 0.5 * y * y + 3 * x + x * y; });
  const ViewSource source(cells.view());
  SurfaceSampler surface(source, 2);
  for (double x = 3; x < 590; x += 7.3)
    for (double y = 3; y < 290; y += 11.7) {
      const SurfacePoint point = surface.at(x, y);
      ASSERT_NEAR(point.elevation_m, 0.25 * x * x - 0.5 * y * y + 3 * x + x * y, 0.05) << x << "," << y;
      ASSERT_NEAR(point.per_cell_x, 0.5 * x + 3 + y, 0.1);
      ASSERT_NEAR(point.per_cell_y, -y + x, 0.1);
    }
}

TEST(Surface, PassesThroughTheCells) {
  const Raster<float> cells = make(40, 30, [](double x, double y) { return 100 * std::sin(x) * std::cos(2 * y); });
  const ViewSource source(cells.view());
  SurfaceSampler surface(source);
  for (std::int64_t y = 0; y < 30; ++y)
    for (std::int64_t x = 0; x < 40; ++x) ASSERT_NEAR(surface.at(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5).elevation_m, cells(x, y), 1e-5);
}

// The same from both sides of cell borders and of tile borders.
TEST(Surface, IsContinuousWithItsGradient) {
  const Raster<float> cells = make(600, 20, [](double x, double y) { return 50 * std::sin(0.9 * x) + 10 * std::cos(y); });
  const ViewSource source(cells.view());
  SurfaceSampler surface(source);
  constexpr double e = 1e-7;
  for (double border : {10.0, 10.5, 256.0, 255.5, 256.5, 512.0}) {
    const SurfacePoint before = surface.at(border - e, 7.3), after = surface.at(border + e, 7.3);
    EXPECT_NEAR(before.elevation_m, after.elevation_m, 1e-4) << border;
    EXPECT_NEAR(before.per_cell_x, after.per_cell_x, 1e-4) << border;
    EXPECT_NEAR(before.per_cell_y, after.per_cell_y, 1e-4) << border;
  }
}

TEST(Surface, VoidsAndTheOutsideAreVoid) {
  Raster<float> cells(10, 10, 7.25F);
  cells(4, 4) = void_value;
  const ViewSource source(cells.view());
  SurfaceSampler surface(source);
  EXPECT_TRUE(std::isnan(surface.at(4.2, 4.9).elevation_m));
  EXPECT_EQ(surface.at(3.9, 4.5).elevation_m, 7.25);
  EXPECT_EQ(surface.at(0, 10).elevation_m, 7.25);
  EXPECT_TRUE(std::isnan(surface.at(-0.01, 5).elevation_m));
  EXPECT_TRUE(std::isnan(surface.at(5, 10.01).elevation_m));
  EXPECT_TRUE(std::isnan(surface.at(std::nan(""), 5).elevation_m));
}

}  // namespace
}  // namespace arete
