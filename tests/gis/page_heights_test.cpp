#include "gis/page_heights.h"

#include <cmath>
#include <cstdlib>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

constexpr std::uint16_t void_step = PageHeights::void_step;

Raster<float> rough(std::int64_t width, std::int64_t height, double low, double relief) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(low + relief * uniform_at(7, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  return cells;
}

/// The heights again, by zlib of GDAL and by what the header says of the bytes.
std::vector<std::uint16_t> unpack(const std::vector<std::byte>& stream, Size size) {
  std::size_t bytes = 0;
  auto* data = static_cast<unsigned char*>(CPLZLibInflate(stream.data(), stream.size(), nullptr, 0, &bytes));
  const auto count = static_cast<std::size_t>(size.cells()), width = static_cast<std::size_t>(size.width);
  EXPECT_EQ(bytes, 2 * count);
  std::vector<std::uint16_t> steps(count);
  std::vector<int> known(count);
  for (std::size_t i = 0; data != nullptr && i < count; ++i) {
    int foretold = 0;
    if (i >= width && i % width > 0)
      foretold = known[i - 1] + known[i - width] - known[i - width - 1];
    else if (i > 0)
      foretold = i < width ? known[i - 1] : known[i - width];
    foretold = foretold < 0 ? 0 : foretold > PageHeights::max_step ? PageHeights::max_step : foretold;
    const int code = data[i] | data[count + i] << 8;
    known[i] = code == 0 ? foretold : code % 2 == 1 ? foretold + (code - 1) / 2 : foretold - code / 2;
    steps[i] = code == 0 ? void_step : static_cast<std::uint16_t>(known[i]);
  }
  VSIFree(data);
  return steps;
}

TEST(QuantiseHeights, KeepsEachCellWithinHalfARoundStep) {
  for (const double relief : {0.003, 1.0, 49.7, 2817.0, 8848.0, 20000.0}) {
    Raster<float> cells = rough(50, 40, -400, relief);
    cells(3, 4) = void_value;
    const PageHeights heights = quantise_heights(cells.view());
    ASSERT_EQ(heights.steps.size(), 2000u);
    const double exponent = std::floor(std::log10(heights.step_m) + 1e-9), digit = heights.step_m / std::pow(10, exponent);
    EXPECT_TRUE(std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 || std::abs(digit - 5) < 1e-9) << heights.step_m;
    EXPECT_LT(heights.error_m(), relief / 13107 * (1 + 1e-3)) << relief;  // floats near 400 are 3e-5 apart
    for (std::size_t i = 0; i < 2000; ++i) {
      if (i == 4 * 50 + 3) {
        EXPECT_EQ(heights.steps[i], void_step);
        continue;
      }
      ASSERT_LE(heights.steps[i], PageHeights::max_step);
      ASSERT_LE(std::abs(heights.low_m + heights.step_m * heights.steps[i] - static_cast<double>(cells.data()[i])), heights.error_m() * (1 + 1e-6));
    }
  }
}

TEST(QuantiseHeights, KeepsWholeMetresOfAnyTerrainOnEarth) {
  Raster<float> cells(3, 2);
  const float whole[] = {-427, 8849, 12, 1999, 3, 4000};
  for (std::size_t i = 0; i < 6; ++i) cells.data()[i] = whole[i];
  const PageHeights heights = quantise_heights(cells.view());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(heights.low_m + heights.step_m * heights.steps[i], static_cast<double>(whole[i]));
}

TEST(QuantiseHeights, FlatGroundHasNoStepAndNothingButVoidsNoHeight) {
  const PageHeights flat = quantise_heights(Raster<float>(2, 2, 812.5f).view());
  EXPECT_EQ(flat.low_m, 812.5);
  EXPECT_EQ(flat.step_m, 0);
  EXPECT_EQ(flat.steps, (std::vector<std::uint16_t>{0, 0, 0, 0}));
  const PageHeights none = quantise_heights(Raster<float>(2, 1, void_value).view());
  EXPECT_EQ(none.low_m, 0);
  EXPECT_EQ(none.steps, (std::vector<std::uint16_t>{void_step, void_step}));
}

TEST(PackHeights, GivesEveryStepBack) {
  Raster<float> cells = rough(61, 37, 100, 3000);
  for (std::int64_t y = 0; y < 37; ++y)
    for (std::int64_t x = 0; x < 61; ++x)
      if ((x - 20) * (x - 20) + (y - 15) * (y - 15) < 90 || x < 2 || y == 36) cells(x, y) = void_value;
  const PageHeights heights = quantise_heights(cells.view());
  EXPECT_EQ(unpack(pack_heights(heights), heights.size), heights.steps);
}

// Alternating extremes foretell values outside all bounds.
TEST(PackHeights, GivesExtremesBack) {
  Raster<float> cells(16, 16);
  for (std::int64_t y = 0; y < 16; ++y)
    for (std::int64_t x = 0; x < 16; ++x) cells(x, y) = (x * 7 + y * 5) % 3 == 0 ? 16384.0f : (x + y) % 5 == 0 ? void_value : 0.0f;
  const PageHeights heights = quantise_heights(cells.view());
  EXPECT_EQ(unpack(pack_heights(heights), heights.size), heights.steps);
  for (const Size size : {Size{1, 9}, Size{9, 1}, Size{1, 1}}) {
    const PageHeights line = quantise_heights(rough(size.width, size.height, 0, 10).view());
    EXPECT_EQ(unpack(pack_heights(line), size), line.steps);
  }
}

TEST(PackHeights, IsSmallWhereGroundIsSmooth) {
  Raster<float> cells(200, 200);
  for (std::int64_t y = 0; y < 200; ++y)
    for (std::int64_t x = 0; x < 200; ++x) cells(x, y) = static_cast<float>(500 * std::sin(0.02 * static_cast<double>(x)) * std::cos(0.03 * static_cast<double>(y)));
  EXPECT_LT(pack_heights(quantise_heights(cells.view())).size(), 200u * 200u);  // a bit more than half of it by measure; 2 bytes a cell unpacked
}

}  // namespace
}  // namespace arete
