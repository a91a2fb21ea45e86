#include "shaders/develop.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

LightRows flat(Size size, std::array<float, 4> light, std::int64_t y = 0) {
  LightRows rows{y, size, std::vector<float>(static_cast<std::size_t>(4 * size.cells()))};
  for (std::size_t i = 0; i < rows.rgba.size(); ++i) rows.rgba[i] = light[i % 4];
  return rows;
}

// IEC 61966-2-1: 0.2140411 of the light of white is the middle of the range, 0.0031308 / 2 lies on its straight part.
TEST(Develop, FollowsTheCurveOfSrgbInSixteenBits) {
  std::vector<std::uint16_t> out(4);
  develop(flat({1, 1}, {0.2140411f, 0.0015654f, 1, 0.5f}), 1, out.data());
  EXPECT_NEAR(out[0], 0.5 * 65535, 1);
  EXPECT_NEAR(out[1], 12.92 * 0.0015654 * 65535, 1);
  EXPECT_EQ(out[2], 65535);
  EXPECT_NEAR(out[3], 0.5 * 65535, 1);
}

TEST(Develop, ClipsLightBeyondItsRange) {
  std::vector<std::uint16_t> fine(4);
  std::vector<std::uint8_t> coarse(4);
  const LightRows rows = flat({1, 1}, {1.7f, -0.2f, 1, 1});
  develop(rows, 1, fine.data());
  develop(rows, 1, coarse.data());
  EXPECT_EQ(fine, (std::vector<std::uint16_t>{65535, 0, 65535, 65535}));
  EXPECT_EQ(coarse, (std::vector<std::uint8_t>{255, 0, 255, 255}));
}

TEST(Develop, NoiseOfOneStepKeepsTheMeanOfFlatLight) {
  std::vector<std::uint8_t> out(4 * 128 * 128);
  for (const float light : {0.003f, 0.0533f, 0.3401f, 0.81f}) {
    develop(flat({128, 128}, {light, light, light, 1}), 2, out.data());
    std::vector<std::uint16_t> exact(4);
    develop(flat({1, 1}, {light, light, light, 1}), 1, exact.data());
    const double wanted = exact[0] / 257.0;
    double sum = 0;
    for (std::size_t i = 0; i < out.size(); i += 4) {
      EXPECT_LT(std::abs(out[i] - wanted), 1);
      sum += out[i];
    }
    // 16384 draws: the mean of noise of one step is off by 0.004 in the mean.
    EXPECT_NEAR(sum / (128 * 128), wanted, 0.02);
  }
}

TEST(Develop, PartsAndTheirRowsHaveTheSameBytes) {
  for (const int supersampling : {1, 2}) {
    // Halves of light from 0 to 2: exponents up to 15.
    const PicturePart part{3, 5, 20, 11};
    std::vector<std::uint16_t> halves(static_cast<std::size_t>(4 * part.width * part.height * supersampling * supersampling));
    for (std::size_t i = 0; i < halves.size(); ++i) halves[i] = static_cast<std::uint16_t>(hash_position(3, i, 0) % 0x4000);
    const DrawnPart drawn{halves, supersampling, part};
    const Size picture{30, 18};
    std::vector<std::uint8_t> whole(static_cast<std::size_t>(4 * picture.cells())), of_rows(static_cast<std::size_t>(4 * picture.width * part.height));
    develop(drawn, 2, picture.width, whole.data());
    LightRows rows = flat({picture.width, part.height}, {0, 0, 0, 0}, part.y);
    average(drawn, 2, rows);
    develop(rows, 1, of_rows.data());
    for (std::int64_t y = 0; y < part.height; ++y)
      for (std::int64_t i = 4 * part.x; i < 4 * (part.x + part.width); ++i)
        ASSERT_EQ(whole[static_cast<std::size_t>(4 * (part.y + y) * picture.width + i)], of_rows[static_cast<std::size_t>(4 * y * picture.width + i)]) << supersampling;
  }
}

TEST(Develop, AveragesLightUpsideDown) {
  // 2 x 2 pixels of 2 x 2: light 0x3c00 is 1, 0x3800 0.5, 0x4000 2; the upper row comes last.
  const std::uint16_t o = 0, h = 0x3800, i = 0x3c00, t = 0x4000;
  const std::uint16_t pixels[4][4] = {{o, o, t, t}, {o, o, t, t}, {i, o, h, h}, {o, o, h, o}};
  std::vector<std::uint16_t> halves;
  for (const auto& row : pixels)
    for (const std::uint16_t value : row) halves.insert(halves.end(), {value, value, value, i});
  LightRows rows = flat({2, 2}, {9, 9, 9, 9});
  average({halves, 2, {0, 0, 2, 2}}, 1, rows);
  const float wanted[] = {0.25f, 0.375f, 0, 2};
  for (std::size_t p = 0; p < 4; ++p) {
    EXPECT_EQ(rows.rgba[4 * p], wanted[p]);
    EXPECT_EQ(rows.rgba[4 * p + 3], 1);
  }
}

TEST(Develop, NoiseDependsOnThePlaceInThePictureAlone) {
  const std::array<float, 4> light = {0.3f, 0.4f, 0.5f, 1};
  std::vector<std::uint8_t> whole(4 * 40 * 30), part(4 * 40 * 12);
  develop(flat({40, 30}, light), 1, whole.data());
  develop(flat({40, 12}, light, 18), 3, part.data());
  EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + 4 * 40 * 18));
}

}  // namespace
}  // namespace arete
