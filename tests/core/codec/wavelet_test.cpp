#include "core/codec/wavelet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/codec/codec_terrain.h"

namespace arete {
namespace {

constexpr int half_reach = wavelet_reach / 2;

struct Analysed {
  Raster<float> low;
  std::array<Raster<float>, band_count> bands;
};

Analysed analyse_all(const Raster<float>& cells) {
  const std::int64_t w = (cells.width() + 1) / 2, h = (cells.height() + 1) / 2;
  Raster<float> padded(2 * w + 2 * wavelet_reach, 2 * h + 2 * wavelet_reach);
  for (std::int64_t y = 0; y < padded.height(); ++y)
    for (std::int64_t x = 0; x < padded.width(); ++x)
      padded(x, y) = cells(mirrored_index(x - wavelet_reach, cells.width()), mirrored_index(y - wavelet_reach, cells.height()));
  Analysed result{Raster<float>(w, h), {}};
  for (Raster<float>& band : result.bands) band = Raster<float>(w, h);
  analyse(padded.view(), result.low.view(), {result.bands[0].view(), result.bands[1].view(), result.bands[2].view()});
  return result;
}

float coefficient(const Raster<float>& band, std::int64_t x, std::int64_t y, int odd_x, int odd_y, const Size& samples) {
  const std::int64_t i = mirrored_index(2 * (x - half_reach) + odd_x, samples.width), j = mirrored_index(2 * (y - half_reach) + odd_y, samples.height);
  return i % 2 != odd_x || j % 2 != odd_y ? 0.0F : band(i / 2, j / 2);
}

Raster<float> synthesise_all(const Analysed& from, const Size& samples) {
  const std::int64_t w = from.low.width(), h = from.low.height();
  std::array<Raster<float>, 4> padded;
  for (int b = 0; b < 4; ++b) {
    const Raster<float>& band = b == 0 ? from.low : from.bands[static_cast<std::size_t>(b - 1)];
    Raster<float>& to = padded[static_cast<std::size_t>(b)] = Raster<float>(w + wavelet_reach, h + wavelet_reach);
    for (std::int64_t y = 0; y < to.height(); ++y)
      for (std::int64_t x = 0; x < to.width(); ++x) to(x, y) = coefficient(band, x, y, b & 1, b >> 1, samples);
  }
  Raster<float> result(2 * w, 2 * h);
  synthesise(padded[0].view(), {padded[1].view(), padded[2].view(), padded[3].view()}, result.view());
  return result;
}

class WaveletSizes : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(WaveletSizes, SynthesisInvertsAnalysis) {
  const auto [width, height] = GetParam();
  const Raster<float> cells = codec_terrain(width, height);
  const Raster<float> again = synthesise_all(analyse_all(cells), cells.size());
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) ASSERT_NEAR(again(x, y), cells(x, y), 2e-3) << x << "," << y;
}

INSTANTIATE_TEST_SUITE_P(, WaveletSizes,
                         testing::Values(std::pair{64, 64}, std::pair{37, 23}, std::pair{1, 9}, std::pair{8, 1}, std::pair{2, 2}, std::pair{3, 2},
                                         std::pair{1, 1}));

TEST(Wavelet, ConstantsHaveNoDetailAndKeepTheirElevation) {
  const Raster<float> cells(40, 30, 1234.5F);
  const Analysed result = analyse_all(cells);
  for (std::int64_t i = 0; i < result.low.size().cells(); ++i) {
    EXPECT_NEAR(result.low.data()[i], 1234.5F, 1e-3);
    for (const Raster<float>& band : result.bands) EXPECT_NEAR(band.data()[i], 0, 1e-3);
  }
}

// An error of one coefficient of the finest level, in the elevations: its norm is that of the synthesis function.
TEST(Wavelet, NormsAreThoseOfTheSynthesis) {
  for (int band = 0; band <= band_count; ++band) {
    Analysed impulse{Raster<float>(32, 32, 0.0F), {Raster<float>(32, 32, 0.0F), Raster<float>(32, 32, 0.0F), Raster<float>(32, 32, 0.0F)}};
    (band == band_count ? impulse.low : impulse.bands[static_cast<std::size_t>(band)])(16, 16) = 1;
    const Raster<float> response = synthesise_all(impulse, {64, 64});
    double squares = 0;
    for (std::int64_t i = 0; i < response.size().cells(); ++i) squares += static_cast<double>(response.data()[i]) * response.data()[i];
    EXPECT_NEAR(std::sqrt(squares), band_norm(1, band), 1e-5) << band;
  }
}

TEST(Wavelet, NormsGrowByRootTwoALevelInEachDirection) {
  for (int band = 0; band <= band_count; ++band)
    for (int level = 8; level < 30; ++level) EXPECT_NEAR(band_norm(level + 1, band) / band_norm(level, band), 2, 2e-3);
}

TEST(Wavelet, MirrorsAboutTheEnds) {
  EXPECT_EQ(mirrored_index(-3, 10), 3);
  EXPECT_EQ(mirrored_index(10, 10), 8);
  EXPECT_EQ(mirrored_index(-5, 3), 1);
  EXPECT_EQ(mirrored_index(7, 1), 0);
}

}  // namespace
}  // namespace arete
