#include "core/codec/patch_weights.h"

#include <gtest/gtest.h>

#include "core/codec/patch_parameters.h"

namespace arete {
namespace {

TEST(PatchWeights, AreTheFalloffRoundedDown) {
  for (int radius : {2, 7, 32}) {
    const std::vector<std::int32_t> weights = integer_disc_weights(2 * radius);
    const std::vector<float> real = disc_weights(2 * radius);
    ASSERT_EQ(weights.size(), real.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_LE(weights[i], static_cast<double>(real[i]) * 65536 + 0.01);
      EXPECT_GT(weights[i], static_cast<double>(real[i]) * 65536 - 1.01);
    }
  }
}

// Four discs over every cell, at pitch R: one half at least (sparse tree, D2), less what rounding takes.
TEST(PatchWeights, CoverIsAtLeastOneHalf) {
  for (int radius = least_patch_radius; radius <= greatest_patch_radius; ++radius) {
    const std::vector<std::int32_t> weights = integer_disc_weights(2 * radius);
    for (int y = 0; y < radius; ++y)
      for (int x = 0; x < radius; ++x) {
        std::int32_t sum = 0;
        for (int j : {0, radius})
          for (int i : {0, radius}) sum += weights[static_cast<std::size_t>((y + j) * 2 * radius + x + i)];
        EXPECT_GE(sum, 32768 - 4) << radius;
        EXPECT_LE(sum, 65536);
      }
  }
}

}  // namespace
}  // namespace arete
