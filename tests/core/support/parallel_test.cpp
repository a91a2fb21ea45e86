#include "core/support/parallel.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace {

class ParallelFor : public testing::TestWithParam<int> {};

TEST_P(ParallelFor, VisitsEachIndexOnce) {
  std::vector<int> visits(10007, 0);
  arete::parallel_for(10007, GetParam(), [&](std::int64_t i) { ++visits[static_cast<std::size_t>(i)]; });
  for (const int count : visits) ASSERT_EQ(count, 1);
}

TEST_P(ParallelFor, ThrowsWhatABodyThrows) {
  const auto body = [](std::int64_t i) {
    if (i == 41) throw arete::Error(arete::ErrorKind::input, "forty-one");
  };
  try {
    arete::parallel_for(100, GetParam(), body);
    FAIL() << "nothing was thrown";
  } catch (const arete::Error& error) {
    EXPECT_STREQ(error.what(), "forty-one");
    EXPECT_EQ(error.kind(), arete::ErrorKind::input);
  }
}

TEST_P(ParallelFor, NestsAndTakesNothing) {
  std::vector<int> cells(64 * 64, 0);
  arete::parallel_for(64, GetParam(), [&](std::int64_t y) {
    arete::parallel_for(64, GetParam(), [&](std::int64_t x) { cells[static_cast<std::size_t>(64 * y + x)] = 1; });
  });
  for (const int cell : cells) ASSERT_EQ(cell, 1);
  arete::parallel_for(0, GetParam(), [](std::int64_t) { FAIL(); });
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(0, 1, 2, 7));

TEST(ResolveThreads, TakesTheRequestOrAllCores) {
  EXPECT_EQ(arete::resolve_threads(3), 3);
  EXPECT_GE(arete::resolve_threads(0), 1);
}

}  // namespace
