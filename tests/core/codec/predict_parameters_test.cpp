#include "core/codec/predict_parameters.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

PredictParameters some_parameters(std::uint64_t seed) {
  PredictParameters file;
  file.lowest = -70000;
  file.highest = 123456;
  file.root_step = 9;
  file.levels.assign(5, default_level_parameters());
  const auto pick = [&](std::uint64_t i, std::int32_t range) {
    return static_cast<std::int32_t>(hash_position(seed, i) % static_cast<std::uint64_t>(2 * range + 1)) - range;
  };
  std::uint64_t n = 0;
  for (LevelParameters& level : file.levels) {
    level.step = 1 + std::abs(pick(n++, 3));
    for (std::size_t p = 0; p < coded_phases; ++p) {
      PhaseParameters& phase = level.phases[p];
      const std::size_t pairs = p == 2 ? 14 : 12;
      std::int32_t sum = 0;
      for (std::size_t i = 1; i < pairs; ++i) sum += phase.taps[i] += tap_grain * pick(n++, 20);
      phase.taps[0] = 2048 - sum;
      for (std::int32_t& weight : phase.recursion) weight = recursion_grain * pick(n++, 16);
      for (std::uint8_t& weight : phase.activity) weight = static_cast<std::uint8_t>(std::abs(pick(n++, 255)));
      phase.noise = std::abs(pick(n++, 119));
    }
  }
  return file;
}

TEST(PredictParameters, ComeBackAsTheyWere) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PredictParameters file = some_parameters(seed);
    const PredictParameters read = decode_parameters(encode_parameters(file), 5, "x.sct");
    EXPECT_EQ(read.lowest, file.lowest);
    EXPECT_EQ(read.highest, file.highest);
    EXPECT_EQ(read.root_step, file.root_step);
    for (std::size_t l = 0; l < 5; ++l) {
      EXPECT_EQ(read.levels[l].step, file.levels[l].step);
      for (std::size_t p = 0; p < coded_phases; ++p) {
        EXPECT_EQ(read.levels[l].phases[p].taps, file.levels[l].phases[p].taps);
        EXPECT_EQ(read.levels[l].phases[p].recursion, file.levels[l].phases[p].recursion);
        EXPECT_EQ(read.levels[l].phases[p].activity, file.levels[l].phases[p].activity);
        EXPECT_EQ(read.levels[l].phases[p].noise, file.levels[l].phases[p].noise);
      }
    }
  }
}

TEST(PredictParameters, DefaultsCostLittle) {
  PredictParameters file;
  file.levels.assign(10, default_level_parameters());
  EXPECT_LT(encode_parameters(file).size(), 60u);
}

TEST(PredictParameters, NoiseFloorsAreQuarterOctaves) {
  EXPECT_EQ(noise_floor(0), 1U);
  EXPECT_EQ(noise_floor(8), 4U);
  EXPECT_EQ(noise_floor(9), 5U);
  EXPECT_EQ(noise_floor(32), 256U);  // one unit
  for (int noise = 0; noise < 119; ++noise) EXPECT_LE(noise_floor(noise), noise_floor(noise + 1));
}

// What the decoder relies on, whatever the bytes.
void expect_sound(const PredictParameters& file) {
  ASSERT_LE(file.lowest, file.highest);
  ASSERT_GE(file.root_step, 1);
  for (const LevelParameters& level : file.levels) {
    ASSERT_GE(level.step, 1);
    ASSERT_LE(level.step, 1 << 24);
    for (const PhaseParameters& phase : level.phases) {
      std::int32_t sum = 0, magnitudes = 0, recursion = 0;
      for (std::int32_t tap : phase.taps) sum += tap, magnitudes += std::abs(tap);
      for (std::int32_t weight : phase.recursion) recursion += std::abs(weight);
      ASSERT_EQ(sum, 2048);
      ASSERT_LE(magnitudes, 8191);
      ASSERT_LE(recursion, 256);
      ASSERT_GE(phase.noise, 0);
      ASSERT_LT(phase.noise, 120);
    }
  }
}

TEST(PredictParameters, HostileBytesAreRefusedOrSound) {
  const auto bytes = encode_parameters(some_parameters(3));
  int refused = 0;
  const auto check = [&](std::span<const std::byte> hostile) {
    try {
      expect_sound(decode_parameters(hostile, 5, "x.sct"));
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::damaged);
      ++refused;
    }
  };
  for (std::size_t length = 0; length < bytes.size(); ++length) check({bytes.data(), length});
  for (std::uint64_t i = 0; i < 2000; ++i) {
    auto flipped = bytes;
    flipped[hash_position(1, i, 0) % flipped.size()] ^= static_cast<std::byte>(1 + hash_position(1, i, 1) % 255);
    check(flipped);
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace arete
