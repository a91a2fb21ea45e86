#include "core/amplify/void_mask.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(VoidMask, MakesTheBlocksOfVoidCellsVoidAndNoOther) {
  Raster<float> coarse(5, 4, 1.0f), fine(15, 12, 2.0f);
  coarse(0, 0) = coarse(3, 2) = coarse(4, 3) = void_value;
  restore_voids(coarse.view(), 3, fine.view());
  for (std::int64_t y = 0; y < 12; ++y)
    for (std::int64_t x = 0; x < 15; ++x) {
      EXPECT_EQ(is_void(fine(x, y)), is_void(coarse(x / 3, y / 3)));
      if (!is_void(fine(x, y))) {
        EXPECT_EQ(fine(x, y), 2.0f);
      }
    }
}

}  // namespace
}  // namespace arete
