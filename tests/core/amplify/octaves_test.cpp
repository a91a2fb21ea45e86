#include "core/amplify/octaves.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

double power(RasterView<const float> cells, std::int64_t border) {
  double sum = 0;
  for (std::int64_t y = border; y + border < cells.height; ++y)
    for (std::int64_t x = border; x + border < cells.width; ++x) sum += std::pow(static_cast<double>(cells(x, y)), 2);
  return sum / static_cast<double>((cells.width - 2 * border) * (cells.height - 2 * border));
}

/// One pass of (1 4 6 4 1)/16 with holes in both directions, in double, the edge repeated.
std::vector<double> plain_smooth(const std::vector<double>& from, std::int64_t w, std::int64_t h, std::int64_t spacing) {
  constexpr double k[] = {1, 4, 6, 4, 1};
  std::vector<double> to(from.size(), 0);
  for (std::int64_t y = 0; y < h; ++y)
    for (std::int64_t x = 0; x < w; ++x)
      for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 5; ++i)
          to[static_cast<std::size_t>(y * w + x)] +=
              k[i] * k[j] / 256 *
              from[static_cast<std::size_t>(std::clamp<std::int64_t>(y + (j - 2) * spacing, 0, h - 1) * w +
                                            std::clamp<std::int64_t>(x + (i - 2) * spacing, 0, w - 1))];
  return to;
}

TEST(Octaves, AreAsManyAsTheFactorHas) {
  const Raster<float> cells(32, 32, 1.0f);
  EXPECT_EQ(split_octaves(cells.view(), 2, 1).size(), 1u);
  EXPECT_EQ(split_octaves(cells.view(), 3, 1).size(), 2u);
  EXPECT_EQ(split_octaves(cells.view(), 4, 1).size(), 2u);
  EXPECT_EQ(split_octaves(cells.view(), 5, 1).size(), 3u);
  EXPECT_EQ(split_octaves(cells.view(), 8, 1).size(), 3u);
}

TEST(Octaves, SumBackWithWhatTheLastFilterPasses) {
  const Raster<float> cells = fractal_terrain(50, 41, 1, 1, -50, 100);
  std::vector<double> rest(cells.data(), cells.data() + cells.size().cells());
  for (const std::int64_t spacing : {1, 2}) rest = plain_smooth(rest, 50, 41, spacing);
  const auto octaves = split_octaves(cells.view(), 4, 2);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i)
    EXPECT_NEAR(static_cast<double>(octaves[0].data()[i]) + static_cast<double>(octaves[1].data()[i]) + rest[static_cast<std::size_t>(i)],
                cells.data()[i], 5e-5);
}

// (1 4 6 4 1)/16 passes cos^4(pi f) of a sine of f cycles per cell; with holes of 2, cos^4(2 pi f).
TEST(Octaves, ASineFallsInItsOwn) {
  constexpr double pi = 3.14159265358979;
  const auto passes = [](double f) { return std::pow(std::cos(pi * f), 4); };
  for (const double period : {2.2, 2.7, 3.7, 4.5, 7.0, 7.8, 16.0, 32.0}) {
    Raster<float> cells(200, 40);
    for (std::int64_t y = 0; y < 40; ++y)
      for (std::int64_t x = 0; x < 200; ++x) cells(x, y) = static_cast<float>(std::sin(2 * pi * static_cast<double>(x) / period));
    const auto octaves = split_octaves(cells.view(), 4, 2);
    const double finest = power(octaves[0].view(), 8) / power(cells.view(), 8), coarser = power(octaves[1].view(), 8) / power(cells.view(), 8);
    EXPECT_NEAR(finest, std::pow(1 - passes(1 / period), 2), 0.01) << period;
    EXPECT_NEAR(coarser, std::pow(passes(1 / period) * (1 - passes(2 / period)), 2), 0.01) << period;
    if (period < 4) {
      EXPECT_GT(finest, 2 * coarser) << period;
    } else if (period > 6 && period < 8) {
      EXPECT_GT(coarser, 2 * finest) << period;
    } else if (period >= 32) {
      EXPECT_LT(coarser + finest, 0.01);
    }
  }
}

TEST(Octaves, AConstantHasNoneAndVoidsCountAsZero) {
  for (const auto& octave : split_octaves(Raster<float>(20, 20, 7.0f).view(), 4, 1))
    for (std::int64_t i = 0; i < 400; ++i) EXPECT_NEAR(octave.data()[i], 0, 1e-6);
  Raster<float> with_void = fractal_terrain(30, 30, 2, 1, -1, 2), zeroed = with_void.clone();
  make_void(with_void, {10, 10, 5, 5});
  for (std::int64_t y = 10; y < 15; ++y)
    for (std::int64_t x = 10; x < 15; ++x) zeroed(x, y) = 0;
  const auto a = split_octaves(with_void.view(), 4, 1), b = split_octaves(zeroed.view(), 4, 1);
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(same_bits(a[k].view(), b[k].view()));
}

TEST(Octaves, ThreadsChangeNoBit) {
  const Raster<float> cells = fractal_terrain(70, 51, 3, 1, -50, 100);
  const auto one = split_octaves(cells.view(), 5, 1), many = split_octaves(cells.view(), 5, 7);
  for (std::size_t k = 0; k < one.size(); ++k) EXPECT_TRUE(same_bits(one[k].view(), many[k].view()));
}

}  // namespace
}  // namespace arete
