#include "core/amplify/blend_kernel.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace arete {
namespace {

constexpr std::int64_t side = 32;

struct Terms {
  explicit Terms(int count) {
    for (int t = 0; t < count; ++t) {
      cells.emplace_back(side * side);
      for (std::size_t i = 0; i < cells.back().size(); ++i)
        cells.back()[i] = static_cast<float>(uniform_at(4, i, static_cast<std::uint64_t>(t)) - 0.5);
      factors.push_back(static_cast<float>(200 * uniform_at(5, static_cast<std::uint64_t>(t))));
    }
    for (const auto& c : cells) blocks.push_back(c.data());
  }
  std::vector<std::vector<float>> cells;
  std::vector<const float*> blocks;
  std::vector<float> factors;
};

TEST(BlendKernel, IsThePlainSumForAnyWidth) {
  for (const int count : {0, 1, 4, 9})
    for (std::int64_t width = 1; width <= 30; ++width) {
      const Terms terms(count);
      std::vector<float> out(40 * 5, -1.0f);
      blend_block(terms.blocks.data(), terms.factors.data(), count, side, 1500.25f, 1e-5f, out.data(), 40, width, 5);
      for (std::int64_t y = 0; y < 5; ++y)
        for (std::int64_t x = 0; x < 40; ++x) {
          double expected = 1e-5;
          for (std::size_t t = 0; t < terms.blocks.size(); ++t)
            expected += static_cast<double>(terms.factors[t]) * static_cast<double>(terms.blocks[t][y * side + x % side]);
          const float found = out[static_cast<std::size_t>(y * 40 + x)];
          if (x < width)
            EXPECT_NEAR(found, 1500.25 + expected, 3e-4) << count << " terms, width " << width << ", x " << x;  // 2 x the spacing at 1500
          else
            EXPECT_EQ(found, -1.0f) << "written beyond the width " << width;
        }
    }
}

TEST(BlendKernel, ACellHasTheSameBitsInABlockOfAnyWidth) {
  const Terms terms(7);
  std::vector<float> whole(side * 4), part(side * 4);
  blend_block(terms.blocks.data(), terms.factors.data(), 7, side, 2000, 0, whole.data(), side, side, 4);
  for (std::int64_t first = 0; first < side; ++first)
    for (const std::int64_t width : {1, 3, 4, 7, 8, 11}) {
      if (first + width > side) continue;
      std::vector<const float*> blocks = terms.blocks;
      for (const float*& b : blocks) b += first;
      blend_block(blocks.data(), terms.factors.data(), 7, side, 2000, 0, part.data(), side, width, 4);
      for (std::int64_t y = 0; y < 4; ++y)
        for (std::int64_t x = 0; x < width; ++x)
          ASSERT_EQ(part[static_cast<std::size_t>(y * side + x)], whole[static_cast<std::size_t>(y * side + x + first)]) << first << " " << width;
    }
}

}  // namespace
}  // namespace arete
