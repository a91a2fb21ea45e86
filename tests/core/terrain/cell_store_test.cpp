#include "core/terrain/cell_store.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace arete {
namespace {

TEST(CellStore, WindowsComeBackFromMemoryAndFile) {
  for (const std::int64_t limit : {std::int64_t{1} << 30, std::int64_t{100}}) {
    CellStore<float> store({40, 30}, {limit, std::filesystem::temp_directory_path().string()}, limit);
    EXPECT_EQ(store.in_memory(), limit > 40 * 30 * 4);
    Raster<float> part(10, 5);
    for (std::int64_t i = 0; i < 50; ++i) part.data()[i] = static_cast<float>(i) + 0.5F;
    store.write({7, 11, 10, 5}, part.view());
    const Raster<float> back = store.read({5, 10, 20, 8});
    for (std::int64_t y = 0; y < 8; ++y)
      for (std::int64_t x = 0; x < 20; ++x) {
        const bool inside = x >= 2 && x < 12 && y >= 1 && y < 6;
        EXPECT_EQ(back(x, y), inside ? part(x - 2, y - 1) : 0.0F);
      }
  }
}

}  // namespace
}  // namespace arete
