#include "gis/mesh/exact.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(ExactSign, SeesWhatDoublesRoundAway) {
  // 2^60 x 1 - 2^60 x 1 + 1 x 2^-900: a double sums 0 or loses the rest.
  const Int128 large = Int128{1} << 60;
  EXPECT_EQ(exact_sign(std::array<Int128, 3>{large, 1, -large}, std::array{1.0, 0x1p-900, 1.0}), 1);
  EXPECT_EQ(exact_sign(std::array<Int128, 3>{large, -1, -large}, std::array{1.0, 0x1p-900, 1.0}), -1);
  EXPECT_EQ(exact_sign(std::array<Int128, 2>{large, -large}, std::array{1.0, 1.0}), 0);
  EXPECT_EQ(exact_sign(std::array<Int128, 1>{0}, std::array{7.0}), 0);
}

TEST(ExactSign, TakesWeightsThatNoDoubleHolds) {
  const Int128 odd = (Int128{1} << 120) + 1;
  EXPECT_EQ(exact_sign(std::array<Int128, 2>{odd, -(odd - 1)}, std::array{0.1, 0.1}), 1);
  EXPECT_EQ(exact_sign(std::array<Int128, 2>{odd - 2, -(odd - 1)}, std::array{0.1, 0.1}), -1);
  EXPECT_EQ(exact_sign(std::array<Int128, 3>{odd, -(odd - 1), -1}, std::array{0.1, 0.1, 0.1}), 0);
  EXPECT_EQ(exact_sign(std::array<Int128, 3>{odd, -(odd - 1), -1}, std::array{0.1, 0.1, std::nextafter(0.1, 1)}), -1);
}

}  // namespace
}  // namespace arete
