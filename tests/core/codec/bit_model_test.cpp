#include "core/codec/bit_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/random.h"

namespace arete {
namespace {

TEST(BitModel, SquashIsTheLogisticFunction) {
  for (int logit = -stretch_limit; logit <= stretch_limit; ++logit) {
    const double expected = std::min(65520.0, std::max(16.0, 65536 / (1 + std::exp(-logit / 256.0))));
    ASSERT_NEAR(squash(logit), expected, 1.5) << logit;
  }
  EXPECT_EQ(squash(-100000), 16U);
  EXPECT_EQ(squash(100000), 65520U);
}

TEST(BitModel, StretchIsItsInverse) {
  for (Probability p = 64; p < 65536 - 64; p += 16)
    ASSERT_NEAR(stretch(p), 256 * std::log((p + 8) / (65536.0 - p - 8)), 2 + 256 * 2.0 / std::min(p + 8, 65528 - p)) << p;
}

TEST(BitModel, LearnsTheFrequencyOfItsBits) {
  for (double frequency : {0.001, 0.1, 0.5, 0.97}) {
    BitModel model;
    for (int i = 0; i < 50000; ++i) model.update(uniform_at(3, i, 0) < frequency, 1000);
    EXPECT_NEAR(model.p() / 65536.0, frequency, 4 * std::sqrt(frequency * (1 - frequency) / 2000) + 1e-4) << frequency;
  }
}

TEST(BitMixer, FollowsThePredictionThatHolds) {
  BitMixer<2> mixer;
  double cost = 0;
  for (int i = 0; i < 20000; ++i) {
    const int bit = uniform_at(4, i, 0) < 0.5;
    const std::array<int, 2> logits{bit ? 600 : -600, uniform_at(5, i, 0) < 0.5 ? 600 : -600};  // one knows, one guesses
    const Probability p = mixer.mix(logits);
    if (i >= 10000) cost -= std::log2((bit ? p : 65536 - p) / 65536.0);
    mixer.update(logits, p, bit, 6);
  }
  EXPECT_LT(cost / 10000, 0.02);
  EXPECT_GT(mixer.weights[0], 4 * std::abs(mixer.weights[1]));
}

}  // namespace
}  // namespace arete
