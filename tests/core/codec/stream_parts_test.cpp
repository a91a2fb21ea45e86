#include "core/codec/stream_parts.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(StreamParts, JoinAndSplit) {
  for (std::size_t first : {0, 1, 300})
    for (std::size_t rest : {0, 1, 5}) {
      const StreamParts parts{std::vector<std::byte>(first, std::byte{1}), std::vector<std::byte>(rest, std::byte{2})};
      const StreamParts back = split_parts(join_parts(parts), "x");
      EXPECT_EQ(back.first, parts.first);
      EXPECT_EQ(back.rest, parts.rest);
    }
  EXPECT_TRUE(join_parts({}).empty());
}

TEST(StreamParts, AFirstPartBeyondTheStreamIsDamage) { EXPECT_THROW(split_parts(std::vector<std::byte>(1, std::byte{9}), "x"), Error); }

}  // namespace
}  // namespace arete
