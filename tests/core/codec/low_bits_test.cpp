#include "core/codec/low_bits.h"

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

std::vector<std::uint64_t> numbers_of(std::size_t count, int bits) {
  std::vector<std::uint64_t> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = hash_position(1, i) >> (64 - bits);
  return numbers;
}

TEST(LowBits, ComeBackForEveryWidth) {
  for (int bits : {1, 7, 8, 23, 33})
    for (std::size_t count : {std::size_t{1}, std::size_t{100}, std::size_t{3001}}) {
      const std::vector<std::uint64_t> numbers = numbers_of(count, bits);
      EXPECT_EQ(unpack_low_bits(pack_low_bits(numbers, bits), count, bits, "x"), numbers) << bits << " " << count;
    }
  EXPECT_TRUE(pack_low_bits(std::vector<std::uint64_t>(50), 20).empty());
  EXPECT_EQ(unpack_low_bits({}, 3, 20, "x"), std::vector<std::uint64_t>(3));
}

TEST(LowBits, OfAnotherCountAreRefused) {
  const std::vector<std::byte> packed = pack_low_bits(numbers_of(100, 23), 23);
  EXPECT_THROW(unpack_low_bits(packed, 99, 23, "x"), Error);
  EXPECT_THROW(unpack_low_bits(packed, 200, 23, "x"), Error);
  EXPECT_THROW(unpack_low_bits(std::vector<std::byte>(5, std::byte{7}), 100, 23, "x"), Error);
}

}  // namespace
}  // namespace arete
