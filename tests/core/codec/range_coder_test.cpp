#include "core/codec/range_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/support/random.h"

namespace arete {
namespace {

struct Coded {
  std::vector<int> bits;
  std::vector<Probability> probabilities;
  double information_bits = 0;
};

// Bits that follow the probabilities they are coded with.
Coded random_bits(int count, double skew) {
  Coded coded;
  for (int i = 0; i < count; ++i) {
    const double p = std::pow(uniform_at(1, i, 0), skew);
    const auto fixed = static_cast<Probability>(std::min(65520.0, std::max(16.0, p * 65536)));
    const int bit = uniform_at(2, i, 0) * 65536 < fixed;
    coded.bits.push_back(bit);
    coded.probabilities.push_back(fixed);
    coded.information_bits -= std::log2((bit ? fixed : 65536 - fixed) / 65536.0);
  }
  return coded;
}

std::vector<std::byte> encode(const Coded& coded) {
  RangeEncoder encoder;
  for (std::size_t i = 0; i < coded.bits.size(); ++i) encoder.encode(coded.bits[i], coded.probabilities[i]);
  return encoder.finish();
}

TEST(RangeCoder, GivesBackEveryBit) {
  for (double skew : {0.1, 1.0, 8.0}) {
    const Coded coded = random_bits(100000, skew);
    const std::vector<std::byte> bytes = encode(coded);
    RangeDecoder decoder(bytes);
    for (std::size_t i = 0; i < coded.bits.size(); ++i)
      ASSERT_EQ(decoder.decode(coded.probabilities[i]), coded.bits[i]) << "bit " << i << " at skew " << skew;
  }
}

TEST(RangeCoder, CostsTheInformation) {
  for (double skew : {0.1, 1.0, 8.0}) {
    const Coded coded = random_bits(100000, skew);
    EXPECT_LT(8.0 * static_cast<double>(encode(coded).size()), 1.001 * coded.information_bits + 32) << skew;
  }
}

TEST(RangeCoder, EveryShortStreamEndsWell) {
  for (int length = 0; length < 200; ++length) {
    const Coded coded = random_bits(length, 0.5 + 0.05 * length);
    const std::vector<std::byte> bytes = encode(coded);
    RangeDecoder decoder(bytes);
    for (std::size_t i = 0; i < coded.bits.size(); ++i) ASSERT_EQ(decoder.decode(coded.probabilities[i]), coded.bits[i]) << length;
  }
}

TEST(RangeCoder, RawBitsComeBackInOrder) {
  RangeEncoder encoder;
  encoder.encode_raw(0xdeadbeef, 32);
  encoder.encode_raw(5, 3);
  encoder.encode_raw(0, 0);
  const std::vector<std::byte> bytes = encoder.finish();
  RangeDecoder decoder(bytes);
  EXPECT_EQ(decoder.decode_raw(32), 0xdeadbeefU);
  EXPECT_EQ(decoder.decode_raw(3), 5U);
}

TEST(RangeCoder, ReadsZerosPastTheEnd) {
  RangeDecoder decoder({});
  int ones = 0;
  for (int i = 0; i < 100000; ++i) ones += decoder.decode(16);
  EXPECT_EQ(ones, 100000);  // the lowest value of every interval stands for a 1
}

}  // namespace
}  // namespace arete
