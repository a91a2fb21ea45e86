#include "core/support/deflate.h"

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace arete {
namespace {

std::vector<std::byte> some_bytes(std::size_t count) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>(i * i / 100);
  return bytes;
}

TEST(Deflate, GivesBackTheBytes) {
  for (std::size_t count : {0U, 1U, 1000U, 300000U}) EXPECT_EQ(inflate_bytes(deflate_bytes(some_bytes(count)), count, "x"), some_bytes(count));
}

TEST(Deflate, RefusesMoreThanTheLimit) { EXPECT_THROW(inflate_bytes(deflate_bytes(some_bytes(1000)), 999, "x"), Error); }

TEST(Deflate, RefusesWhatIsCutOrGoesOn) {
  std::vector<std::byte> packed = deflate_bytes(some_bytes(1000));
  for (std::size_t length = 0; length < packed.size(); ++length) EXPECT_THROW(inflate_bytes(std::span(packed).first(length), 1000, "x"), Error) << length;
  packed.push_back(std::byte{0});
  EXPECT_THROW(inflate_bytes(packed, 1000, "x"), Error);
}

}  // namespace
}  // namespace arete
