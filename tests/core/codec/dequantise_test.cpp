#include "core/codec/dequantise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace arete {
namespace {

// The formula of core/codec/tree-format.md, 6.4, at lengths with and without a rest beside whole vectors.
TEST(Dequantise, RowsAreTheFormula) {
  const Dequantiser dequantiser{{0, 17.0F / 256, 31.0F / 256, 200.0F / 256}, 0.37F};
  for (std::int64_t count : {0, 1, 7, 64, 131}) {
    std::vector<std::int32_t> points;
    for (std::int64_t i = 0; i < count; ++i) points.push_back(static_cast<std::int32_t>(i % 11 == 10 ? -(1 << 29) + i : i % 9 - 4));
    std::vector<float> details(points.size() + 1, 99.0F);
    dequantise_row(dequantiser, points.data(), details.data(), count);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::int32_t magnitude = points[i] < 0 ? -points[i] : points[i];
      const float size = (static_cast<float>(magnitude) - dequantiser.shrink[static_cast<std::size_t>(std::min(magnitude, 3))]) * dequantiser.scale;
      EXPECT_EQ(details[i], points[i] == 0 ? 0.0F : points[i] < 0 ? -size : size) << points[i];
    }
    EXPECT_EQ(details.back(), 99.0F);
  }
}

}  // namespace
}  // namespace arete
