#include "core/terrain/spectrum.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

Raster<float> noise(std::int64_t width, std::int64_t height, float scale = 1) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = scale * static_cast<float>(uniform_at(5, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) - 0.5);
  return cells;
}

Raster<float> wave(std::int64_t width, std::int64_t height, double cycles_per_cell) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(std::sin(2 * std::numbers::pi * cycles_per_cell * static_cast<double>(x)));
  return cells;
}

TEST(Octaves, GoFromTheNyquistFrequencyOfTheInputToThatOfTheResult) {
  const auto four = octaves_above_nyquist(4);
  ASSERT_EQ(four.size(), 2u);
  EXPECT_EQ(four[0].lower, 0.125);
  EXPECT_EQ(four[0].upper, 0.25);
  EXPECT_EQ(four[1].upper, 0.5);
  const auto three = octaves_above_nyquist(3);
  ASSERT_EQ(three.size(), 2u);
  EXPECT_DOUBLE_EQ(three[0].upper, 1.0 / 3);
  EXPECT_EQ(three[1].upper, 0.5);
  EXPECT_EQ(octaves_above_nyquist(2).size(), 1u);
}

TEST(CompareSpectra, TwiceTheHeightIsFourTimesThePower) {
  const SpectrumComparison s = compare_spectra(noise(300, 300).view(), noise(300, 300, 2).view(), {});
  EXPECT_EQ(s.tile, 256);
  for (const BandPower& band : s.bands) EXPECT_NEAR(band.ratio(), 4, 1e-9);
}

TEST(CompareSpectra, ARasterEqualsItself) {
  const Raster<float> cells = noise(256, 256);
  for (const BandPower& band : compare_spectra(cells.view(), cells.view(), {}).bands) EXPECT_NEAR(band.ratio(), 1, 1e-12);
}

TEST(CompareSpectra, ASineFallsInItsOctave) {
  const Raster<float> low = wave(256, 256, 0.18), high = wave(256, 256, 0.35);
  const SpectrumComparison s = compare_spectra(low.view(), high.view(), {});
  // The power of sin is 1/2; Hann's side lobes fall fast.
  EXPECT_NEAR(s.bands[0].reference, 0.5, 1e-3);
  EXPECT_LT(s.bands[1].reference, 1e-6);
  EXPECT_LT(s.bands[0].result, 1e-6);
  EXPECT_NEAR(s.bands[1].result, 0.5, 1e-3);
}

TEST(CompareSpectra, WhiteNoiseHasTheDensityOfItsVariance) {
  const SpectrumComparison s = compare_spectra(noise(1024, 1024).view(), noise(1024, 1024).view(), {});
  ASSERT_EQ(s.reference.size(), 129u);
  // Uniform on an interval of length 1: variance 1/12, spread evenly over the unit square of frequencies. Ring i averages about
  // pi i different frequencies, of which the window leaves some 2/5 independent, in about 25 independent tiles: at ring 20
  // a standard deviation of 4 %.
  for (std::size_t i = 20; i < 129; ++i) EXPECT_NEAR(s.reference[i] * 12, 1, 0.16) << i;
}

TEST(CompareSpectra, APlaneHasNoPower) {
  Raster<float> a = noise(128, 128), b = a.clone();
  for (std::int64_t y = 0; y < 128; ++y)
    for (std::int64_t x = 0; x < 128; ++x) b(x, y) += static_cast<float>(2 * x - y);
  for (const BandPower& band : compare_spectra(a.view(), b.view(), {}).bands) EXPECT_NEAR(band.ratio(), 1, 1e-3);
}

TEST(CompareSpectra, VoidsDoNotLeak) {
  Raster<float> a = noise(512, 512), b = noise(512, 512, 2);
  a(200, 200) = void_value;
  b(400, 300) = void_value;
  const SpectrumComparison s = compare_spectra(a.view(), b.view(), {});
  EXPECT_GT(s.tiles, 0);
  EXPECT_GE(s.coverage, 0.5);
  for (const BandPower& band : s.bands) EXPECT_NEAR(band.ratio(), 4, 1e-9);
}

TEST(CompareSpectra, FallsBackToSmallerTiles) {
  Raster<float> a = noise(512, 512);
  for (std::int64_t i = 0; i < 512; i += 64)
    for (std::int64_t j = 0; j < 512; j += 64) a(i, j) = void_value;
  const SpectrumComparison s = compare_spectra(a.view(), noise(512, 512, 2).view(), {});
  EXPECT_LE(s.tile, 32);
  EXPECT_GE(s.coverage, 0.5);
  for (const BandPower& band : s.bands) EXPECT_NEAR(band.ratio(), 4, 1e-9);
}

TEST(CompareSpectra, TheBorderIsLeftOut) {
  Raster<float> a = noise(280, 280), b = noise(280, 280, 2);
  for (std::int64_t x = 0; x < 280; ++x) b(x, 3) = 1000;
  SpectrumOptions options;
  options.border = 12;
  const SpectrumComparison s = compare_spectra(a.view(), b.view(), options);
  EXPECT_EQ(s.tile, 256);
  EXPECT_NEAR(s.bands[1].ratio(), 4, 1e-9);
}

TEST(CompareSpectra, WithoutAnyWholeTileThereAreNoRatios) {
  const SpectrumComparison s = compare_spectra(noise(12, 40).view(), noise(12, 40).view(), {});
  EXPECT_EQ(s.tile, 0);
  for (const BandPower& band : s.bands) EXPECT_TRUE(std::isnan(band.ratio()));
}

TEST(CompareSpectra, IsTheSameForAnyThreadCount) {
  const Raster<float> a = noise(700, 600), b = noise(700, 600, 3);
  SpectrumOptions one, many;
  one.threads = 1, many.threads = 5;
  const SpectrumComparison s = compare_spectra(a.view(), b.view(), one), t = compare_spectra(a.view(), b.view(), many);
  EXPECT_EQ(s.bands[0].result, t.bands[0].result);
  EXPECT_EQ(s.reference, t.reference);
}

}  // namespace
}  // namespace arete
