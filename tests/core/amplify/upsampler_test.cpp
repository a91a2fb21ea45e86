#include "core/amplify/upsampler.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/support/parallel.h"
#include "core/terrain/extend.h"
#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

Upsampler learned(int factor) {
  const Raster<float> exemplar = fractal_terrain(64 * factor, 64 * factor, 1);
  return train_upsampler({exemplar.view()}, factor);
}

/// Nothing to learn from: the ridge alone.
Upsampler unlearned(int factor) { return train_upsampler({Raster<float>(12 * factor, 12 * factor, 5.0f).view()}, factor); }

Raster<float> with_holes(Raster<float> cells) {
  make_void(cells, {10, 8, 9, 5});
  make_void(cells, {0, 20, 4, 4});
  make_void(cells, {25, 0, 1, 12});
  cells(30, 25) = void_value;
  return cells;
}

TEST(Upsampler, TheAreaAverageOfTheResultIsTheInput) {
  for (const int factor : {2, 3, 4, 5})
    for (const Upsampler& upsampler : {learned(factor), unlearned(factor)}) {
      // Each fine cell is rounded once, to at most half the spacing (0.24 mm); the sum of 81 differences of up to 1000 m adds as much again.
      const Raster<float> white = with_holes(white_terrain(40, 32, 2));
      EXPECT_LT(inconsistency_ulp(white.view(), upsample_whole(upsampler, white.view()).view(), factor), 1) << "factor " << factor;
      const Raster<float> fractal = with_holes(fractal_terrain(40, 32, 3));
      EXPECT_LT(inconsistency_ulp(fractal.view(), upsample_whole(upsampler, fractal.view()).view(), factor), 0.5) << "factor " << factor;
    }
}

TEST(Upsampler, ARampGivesTheRampAtBordersCornersAndVoids) {
  for (const int factor : {2, 3, 4, 5})
    for (const Upsampler& upsampler : {learned(factor), unlearned(factor)})
      for (const Plane plane : {Plane{7.3, -4.1}, Plane{-31.7, 0}, Plane{0.013, 0.002}}) {
        const Raster<float> coarse = with_holes(plane.sample(40, 32, 1));
        Raster<float> expected = plane.sample(40 * factor, 32 * factor, factor);
        for (std::int64_t y = 0; y < expected.height(); ++y)
          for (std::int64_t x = 0; x < expected.width(); ++x)
            if (is_void(coarse(x / factor, y / factor))) expected(x, y) = void_value;
        EXPECT_LT(largest_difference(upsample_whole(upsampler, coarse.view()).view(), expected.view()), 1e-3)
            << "factor " << factor << " slope " << plane.east;
      }
}

TEST(Upsampler, AConstantStaysToTheLastBit) {
  const Raster<float> coarse = with_holes(Raster<float>(40, 32, 3141.5927f));
  const Raster<float> fine = upsample_whole(learned(4), coarse.view());
  for (std::int64_t y = 0; y < fine.height(); ++y)
    for (std::int64_t x = 0; x < fine.width(); ++x) {
      ASSERT_EQ(is_void(fine(x, y)), is_void(coarse(x / 4, y / 4)));
      if (!is_void(fine(x, y))) {
        ASSERT_EQ(fine(x, y), 3141.5927f);
      }
    }
}

TEST(Upsampler, BeatsBicubicOnTerrainThatItHasNotSeen) {
  for (const int factor : {2, 4}) {
    const Upsampler upsampler = learned(factor);
    for (const std::uint64_t seed : {11u, 12u, 13u}) {
      const Raster<float> truth = fractal_terrain(48 * factor, 40 * factor, seed);
      const Raster<float> coarse = area_average(truth.view(), factor);
      const double ours = rmse(truth.view(), upsample_whole(upsampler, coarse.view()).view(), 6 * factor);
      const double bicubic = rmse(truth.view(), upsample_bicubic(coarse.view(), factor).view(), 6 * factor);
      EXPECT_LT(ours, 0.95 * bicubic) << "factor " << factor << " seed " << seed;
    }
  }
}

// The prior alone must be a sensible interpolation, not only a consistent one.
TEST(Upsampler, WithNothingToLearnItIsStillBetterThanBlocks) {
  for (const int factor : {2, 4}) {
    const Raster<float> truth = fractal_terrain(40 * factor, 40 * factor, 5), coarse = area_average(truth.view(), factor);
    Raster<float> blocks(truth.width(), truth.height());
    for (std::int64_t y = 0; y < truth.height(); ++y)
      for (std::int64_t x = 0; x < truth.width(); ++x) blocks(x, y) = coarse(x / factor, y / factor);
    EXPECT_LT(rmse(truth.view(), upsample_whole(unlearned(factor), coarse.view()).view(), 6 * factor),
              rmse(truth.view(), blocks.view(), 6 * factor));
  }
}

TEST(Upsampler, TooFewCellsAreNothingToLearnFrom) {
  // 24 x 24 coarse cells have 16 x 16 whole neighbourhoods, fewer than 4 x 81.
  const Raster<float> small = fractal_terrain(96, 96, 4);
  EXPECT_EQ(train_upsampler({small.view()}, 4).weights, unlearned(4).weights);
  EXPECT_EQ(train_upsampler({}, 4).weights, unlearned(4).weights);
  EXPECT_EQ(train_upsampler({Raster<float>(300, 300, void_value).view()}, 4).weights, unlearned(4).weights);
}

TEST(Upsampler, TheLearnedWeightsHaveTheSymmetriesOfTheSquare) {
  const Upsampler u = learned(4);
  const int taps = u.side() * u.side();
  double worst = 0;
  for (std::uint8_t s = 0; s < 8; ++s)
    for (int p = 0; p < 16; ++p)
      for (int k = 0; k < taps; ++k) {
        const CellIndex cell = source_cell(p % 4, p / 4, 4, s), tap = source_cell(k % u.side(), k / u.side(), u.side(), s);
        const float a = u.weights[static_cast<std::size_t>(p * taps + k)];
        const float b = u.weights[static_cast<std::size_t>((cell.y * 4 + cell.x) * taps + tap.y * u.side() + tap.x)];
        worst = std::max(worst, std::abs(static_cast<double>(a) - static_cast<double>(b)));
      }
  EXPECT_LT(worst, 1e-6);
}

/// The raster under one of the 8 symmetries.
Raster<float> turn(const Raster<float>& from, std::uint8_t symmetry) {
  const int side = static_cast<int>(from.width());
  Raster<float> to(side, side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const CellIndex cell = source_cell(x, y, side, symmetry);
      to(x, y) = from(cell.x, cell.y);
    }
  return to;
}

TEST(Upsampler, ATurnedInputGivesTheTurnedResult) {
  const Upsampler upsampler = learned(3);
  Raster<float> coarse = fractal_terrain(30, 30, 6);
  make_void(coarse, {4, 17, 6, 3});
  const Raster<float> fine = upsample_whole(upsampler, coarse.view());
  for (std::uint8_t s = 1; s < 8; ++s)
    EXPECT_LT(largest_difference(upsample_whole(upsampler, turn(coarse, s).view()).view(), turn(fine, s).view()), 1.5e-3) << int{s};
}

TEST(Upsampler, IsLinear) {
  const Upsampler upsampler = learned(4);
  const Raster<float> a = fractal_terrain(30, 30, 7, 2, 0, 50), b = fractal_terrain(30, 30, 8, 2, 0, 50);
  Raster<float> sum(30, 30);
  for (std::int64_t i = 0; i < 900; ++i) sum.data()[i] = 2 * a.data()[i] - b.data()[i];
  const Raster<float> fine_a = upsample_whole(upsampler, a.view()), fine_b = upsample_whole(upsampler, b.view());
  Raster<float> expected(120, 120);
  for (std::int64_t i = 0; i < 14400; ++i) expected.data()[i] = 2 * fine_a.data()[i] - fine_b.data()[i];
  EXPECT_LT(largest_difference(upsample_whole(upsampler, sum.view()).view(), expected.view()), 1e-4);
}

TEST(Upsampler, NeitherWindowNorThreadsChangeABit) {
  const Upsampler upsampler = learned(4);
  const int r = upsampler.reach;
  const Raster<float> coarse = fractal_terrain(75, 61, 9);
  const auto window_of = [&](const Window& w, int threads) {
    Raster<float> fine(4 * w.width, 4 * w.height);
    upsample(upsampler, coarse.view().sub({w.x - r, w.y - r, w.width + 2 * r, w.height + 2 * r}), {}, fine.view(), threads);
    return fine;
  };
  const Window all{r, r, 75 - 2 * r, 61 - 2 * r};
  const Raster<float> whole = window_of(all, 1);
  for (const int threads : {2, 3, 7}) EXPECT_TRUE(same_bits(whole.view(), window_of(all, threads).view())) << threads;
  for (const Window& w : {Window{4, 4, 1, 1}, Window{9, 6, 17, 23}, Window{30, 20, 41, 37}, Window{70, 4, 1, 53}}) {
    const Raster<float> part = window_of(w, 2);
    EXPECT_TRUE(same_bits(part.view(), whole.view().sub({4 * (w.x - r), 4 * (w.y - r), 4 * w.width, 4 * w.height}))) << w.x;
  }
}

// Inside parallel_for the matrix products have one thread, outside as many as the machine.
TEST(Upsampler, TrainingDoesNotDependOnThreads) {
  const Raster<float> exemplar = fractal_terrain(512, 400, 1);
  const Upsampler outside = train_upsampler({exemplar.view()}, 4);
  Upsampler inside;
  parallel_for(1, 1, [&](std::int64_t) { inside = train_upsampler({exemplar.view()}, 4); });
  EXPECT_EQ(outside.weights, inside.weights);
}

TEST(Upsampler, DetailIsAddedWithItsAverageTakenOut) {
  const Upsampler upsampler = learned(4);
  const int r = upsampler.reach;
  const Raster<float> coarse = fractal_terrain(30, 26, 10);
  const Window inner{r, r, 30 - 2 * r, 26 - 2 * r};
  Raster<float> detail = white_terrain(120, 104, 11);
  for (std::int64_t i = 0; i < detail.size().cells(); ++i) detail.data()[i] = (detail.data()[i] - 3000) / 50;  // +- 10 m
  const Raster<float> mean = area_average(detail.view(), 4);
  Raster<float> fine = cut_window(detail.view(), {4 * r, 4 * r, 4 * inner.width, 4 * inner.height});
  upsample(upsampler, coarse.view(), mean.view(), fine.view());
  EXPECT_LT(inconsistency_ulp(coarse.view().sub(inner), fine.view(), 4), 1);

  // z' = U(z - D e) + e
  Raster<float> freed(30, 26), expected(4 * inner.width, 4 * inner.height);
  for (std::int64_t i = 0; i < 30 * 26; ++i) freed.data()[i] = coarse.data()[i] - mean.data()[i];
  upsample(upsampler, freed.view(), {}, expected.view());
  for (std::int64_t y = 0; y < expected.height(); ++y)
    for (std::int64_t x = 0; x < expected.width(); ++x) expected(x, y) += detail(x + 4 * r, y + 4 * r);
  EXPECT_LT(largest_difference(fine.view(), expected.view()), 2e-3);
}

TEST(Upsampler, AVoidInTheNeighbourhoodGivesVoid) {
  const Upsampler upsampler = learned(2);
  const int r = upsampler.reach;
  Raster<float> coarse = fractal_terrain(31, 31, 12);
  coarse(15, 15) = void_value;
  Raster<float> fine(2 * (31 - 2 * r), 2 * (31 - 2 * r));
  upsample(upsampler, coarse.view(), {}, fine.view());
  for (std::int64_t y = 0; y < fine.height(); ++y)
    for (std::int64_t x = 0; x < fine.width(); ++x)
      EXPECT_EQ(is_void(fine(x, y)), std::max(std::abs(x / 2 + r - 15), std::abs(y / 2 + r - 15)) <= r) << x << ", " << y;
}

}  // namespace
}  // namespace arete
