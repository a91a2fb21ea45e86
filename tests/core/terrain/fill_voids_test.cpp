#include "core/terrain/fill_voids.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

Raster<float> plane(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = static_cast<float>(500 + 3 * x - 2 * y);
  return cells;
}

void cut_disc(RasterView<float> cells, double cx, double cy, double radius) {
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x)
      if (std::hypot(static_cast<double>(x) - cx, static_cast<double>(y) - cy) < radius) cells(x, y) = void_value;
}

/// Rough ground with holes of all sizes, one of them at the border.
Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const auto i = static_cast<std::uint64_t>(x), j = static_cast<std::uint64_t>(y);
      cells(x, y) = uniform_at(5, i, j) < 0.05 ? void_value : static_cast<float>(1000 * std::sin(0.05 * x) + 200 * uniform_at(6, i, j));
    }
  cut_disc(cells.view(), 0.4 * width, 0.5 * height, 0.2 * height);
  cut_disc(cells.view(), width, height, 0.2 * width);
  return cells;
}

// A linear function is harmonic on the grid, whatever the shape of the hole.
TEST(FillVoids, RestoresAPlane) {
  const Raster<float> truth = plane(400, 300);
  Raster<float> cells = truth.clone();
  cut_disc(cells.view(), 200, 150, 120);
  cut_disc(cells.view(), 30, 30, 9.3);
  cells(390, 290) = void_value;
  const VoidFill fill = fill_voids(cells.view());
  double worst = 0;
  for (std::int64_t y = 0; y < 300; ++y)
    for (std::int64_t x = 0; x < 400; ++x) worst = std::max(worst, std::fabs(static_cast<double>(cells(x, y) - truth(x, y))));
  EXPECT_LT(worst, 0.005);  // of a fall of 720 m over the larger hole
  EXPECT_GT(fill.cells, 45000);
  EXPECT_LT(fill.iterations, 40);
}

TEST(FillVoids, KeepsValidCellsBitForBitAndLeavesNoVoid) {
  const Raster<float> before = rough(240, 200);
  Raster<float> cells = before.clone();
  fill_voids(cells.view());
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) {
    ASSERT_TRUE(std::isfinite(cells.data()[i]));
    if (!is_void(before.data()[i])) {
      ASSERT_EQ(std::memcmp(cells.data() + i, before.data() + i, sizeof(float)), 0);
    }
  }
}

TEST(FillVoids, IsTheMeanOfTheNeighbours) {
  const Raster<float> before = rough(240, 200);
  Raster<float> cells = before.clone();
  fill_voids(cells.view());
  for (std::int64_t y = 0; y < 200; ++y)
    for (std::int64_t x = 0; x < 240; ++x) {
      if (!is_void(before(x, y))) continue;
      double sum = 0;
      int count = 0;
      for (const auto& [nx, ny] : {std::pair{x + 1, y}, {x, y + 1}, {x - 1, y}, {x, y - 1}}) {
        if (nx < 0 || ny < 0 || nx >= 240 || ny >= 200) continue;
        sum += static_cast<double>(cells(nx, ny));
        ++count;
      }
      ASSERT_NEAR(cells(x, y), sum / count, 0.01) << x << ' ' << y;
    }
}

TEST(FillVoids, StaysBetweenTheLowestAndTheHighestCellOfTheRim) {
  Raster<float> cells(64, 64, 100);
  for (std::int64_t x = 0; x < 64; ++x) cells(x, 0) = 5000;  // beyond the rim of the hole below
  for (std::int64_t y = 20; y < 40; ++y)
    for (std::int64_t x = 20; x < 40; ++x) cells(x, y) = void_value;
  cells(19, 30) = 101;
  cells(40, 25) = 99;
  fill_voids(cells.view());
  for (std::int64_t y = 20; y < 40; ++y)
    for (std::int64_t x = 20; x < 40; ++x) {
      ASSERT_GE(cells(x, y), 99);
      ASSERT_LE(cells(x, y), 101);
    }
}

TEST(FillVoids, GivesTheSameBitsTwiceAndForAnyStride) {
  Raster<float> once = rough(150, 130), twice = rough(150, 130), wide(200, 130, 7);
  for (std::int64_t y = 0; y < 130; ++y)
    for (std::int64_t x = 0; x < 150; ++x) wide(x, y) = twice(x, y);
  fill_voids(once.view());
  fill_voids(wide.view().sub({0, 0, 150, 130}));
  for (std::int64_t y = 0; y < 130; ++y)
    for (std::int64_t x = 0; x < 150; ++x) ASSERT_EQ(once(x, y), wide(x, y));
  EXPECT_EQ(wide(199, 129), 7);
}

TEST(FillVoids, FillsAllFromOneValidCell) {
  Raster<float> cells(33, 17, void_value);
  cells(5, 6) = 42;
  fill_voids(cells.view());
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) ASSERT_EQ(cells.data()[i], 42);
}

TEST(FillVoids, RefusesWhatIsAllVoid) {
  Raster<float> cells(3, 3, void_value);
  try {
    fill_voids(cells.view());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
  }
}

TEST(FillVoids, DoesNothingWhereNothingIsVoid) {
  Raster<float> cells = plane(5, 5);
  EXPECT_EQ(fill_voids(cells.view()).cells, 0);
  EXPECT_EQ(cells(4, 4), 504);
}

}  // namespace
}  // namespace arete
