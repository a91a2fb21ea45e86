#include "shaders/develop.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

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

TEST(Develop, NoiseDependsOnThePlaceInThePictureAlone) {
  const std::array<float, 4> light = {0.3f, 0.4f, 0.5f, 1};
  std::vector<std::uint8_t> whole(4 * 40 * 30), part(4 * 40 * 12);
  develop(flat({40, 30}, light), 1, whole.data());
  develop(flat({40, 12}, light, 18), 3, part.data());
  EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + 4 * 40 * 18));
}

}  // namespace
}  // namespace arete
