#include "tests/tools/picture_difference.h"

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

/// Hills of soft colours with a dark disc, as pictures of terrain have edges.
Picture hills(double shift_px = 0) {
  Picture picture(200, 120);
  for (std::int64_t y = 0; y < 120; ++y)
    for (std::int64_t x = 0; x < 200; ++x) {
      const double u = static_cast<double>(x) - shift_px, v = static_cast<double>(y), wave = std::sin(u / 9) * std::cos(v / 7);
      const double inside = std::clamp(20.5 - std::hypot(u - 90, v - 60), 0.0, 1.0);  // smooth at its edge, over one pixel
      const auto mix = [&](double ground, double disc) { return static_cast<std::uint8_t>(std::lround(ground + inside * (disc - ground))); };
      picture(x, y) = {mix(170 + 30 * wave, 50), mix(180 + 20 * wave, 60), mix(150 + 20 * wave, 80), 255};
    }
  return picture;
}

// Reference white, sRGB red and middle grey as the standard's matrices give them (Lindbloom's calculator).
TEST(PictureDifference, MeasuresInLab) {
  const auto near = [](const Lab& lab, const Lab& wanted) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(lab[c], wanted[c], 0.02);
  };
  near(lab_of({1, 1, 1}), {100, 0, 0});
  near(lab_of({1, 0, 0}), {53.24, 80.09, 67.20});
  near(lab_of({0.2140411, 0.2140411, 0.2140411}), {53.39, 0, 0});
  near(lab_of({0, 0, 0}), {0, 0, 0});
  EXPECT_NEAR(picture_difference(Picture(9, 9, {255, 255, 255, 255}), Picture(9, 9, {0, 0, 0, 255})), 100, 1e-4);
}

TEST(PictureDifference, IsNothingWithoutOneAndInfiniteBetweenSizes) {
  EXPECT_EQ(picture_difference(hills(), hills()), 0);
  EXPECT_EQ(picture_difference(hills(), Picture(200, 119)), INFINITY);
}

TEST(PictureDifference, OverlooksNoiseOfOneStepAndEdgesThatMoveWithinAPixel) {
  Picture noisy = hills();
  for (std::size_t i = 0; i < 200 * 120; ++i)
    for (std::size_t c = 0; c < 3; ++c) noisy.data()[i][c] = static_cast<std::uint8_t>(noisy.data()[i][c] + std::floor(3 * uniform_at(1, i, c, 0)) - 1);
  EXPECT_LT(picture_difference(hills(), noisy), 0.5 * alike);
  EXPECT_LT(picture_difference(hills(), hills(0.1)), alike);
}

TEST(PictureDifference, SeesAShiftOfTwoPixelsAnotherTintAndAMark) {
  EXPECT_GT(picture_difference(hills(), hills(2)), 3 * alike);
  Picture tinted = hills(), marked = hills();
  for (std::size_t i = 0; i < 200 * 120; ++i) tinted.data()[i][2] = static_cast<std::uint8_t>(tinted.data()[i][2] - 8);
  EXPECT_GT(picture_difference(hills(), tinted), alike);
  fill(marked, {20, 20, 24, 14}, {45, 45, 48, 255});  // 1.4 % of it
  EXPECT_GT(picture_difference(hills(), marked), 3 * alike);
}

}  // namespace
}  // namespace arete
