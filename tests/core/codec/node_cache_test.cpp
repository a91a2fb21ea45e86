#include "core/codec/node_cache.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

bool holds(NodeCache<int>& cache, std::int64_t index) {
  std::shared_ptr<const int> node;
  return cache.find(index, node);
}

TEST(NodeCache, GivesBackWhatItKeeps) {
  NodeCache<int> cache(10000);
  cache.keep(7, std::make_shared<const int>(70), 100);
  cache.keep(8, nullptr, 0);
  std::shared_ptr<const int> node;
  ASSERT_TRUE(cache.find(7, node));
  EXPECT_EQ(*node, 70);
  ASSERT_TRUE(cache.find(8, node));
  EXPECT_EQ(node, nullptr);
  EXPECT_FALSE(cache.find(9, node));
}

TEST(NodeCache, DropsWhatWasUsedLongestAgo) {
  NodeCache<int> cache(3500);
  for (int i = 0; i < 3; ++i) cache.keep(i, std::make_shared<const int>(i), 1000);
  EXPECT_TRUE(holds(cache, 0));  // now 1 is the oldest
  cache.keep(3, std::make_shared<const int>(3), 1000);
  EXPECT_TRUE(holds(cache, 0));
  EXPECT_FALSE(holds(cache, 1));
  EXPECT_TRUE(holds(cache, 2));
  EXPECT_TRUE(holds(cache, 3));
}

TEST(NodeCache, KeepsNothingThatDoesNotFit) {
  NodeCache<int> none(0), small(500);
  none.keep(1, std::make_shared<const int>(1), 1);
  small.keep(1, std::make_shared<const int>(1), 1000);
  EXPECT_FALSE(holds(none, 1));
  EXPECT_FALSE(holds(small, 1));
}

}  // namespace
}  // namespace arete
