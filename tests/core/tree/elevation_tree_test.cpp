#include "core/tree/elevation_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/error.h"
#include "core/support/random.h"
#include "tests/core/codec/codec_terrain.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

MadeTree tree_with_hole() {
  const Raster<float> terrain = codec_terrain(230, 170);
  Raster<double> cells(230, 170);
  for (std::int64_t y = 0; y < 170; ++y)
    for (std::int64_t x = 0; x < 230; ++x) cells(x, y) = x > 90 && x < 130 && y > 50 && y < 91 ? std::nan("") : terrain(x, y);
  CompressOptions options;
  options.target = {TreeClaim::rmse, 0.5};
  options.node_side = 64;
  TreeHeader header;
  header.geo.metres_per_unit = 0.5;
  return make_tree(MemoryStored(std::move(cells)), header, options);
}

TEST(ElevationTree, WindowsOfEveryLevelAreTheWhole) {
  const MadeTree made = tree_with_hole();
  const ElevationTree tree = open_tree(made, 2);
  for (int level = 0; level <= tree.levels(); ++level) {
    const Size size = tree.level_size(level);
    Raster<float> whole(size.width, size.height);
    tree.read_level(level, {0, 0, size.width, size.height}, whole.view());
    for (std::uint64_t i = 0; i < 12; ++i) {
      const auto x = static_cast<std::int64_t>(hash_position(1, i) % static_cast<std::uint64_t>(size.width));
      const auto y = static_cast<std::int64_t>(hash_position(2, i) % static_cast<std::uint64_t>(size.height));
      const Window window{x, y, 1 + static_cast<std::int64_t>(hash_position(3, i) % static_cast<std::uint64_t>(size.width - x)),
                          1 + static_cast<std::int64_t>(hash_position(4, i) % static_cast<std::uint64_t>(size.height - y))};
      Raster<float> part(window.width, window.height);
      tree.read_level(level, window, part.view());
      for (std::int64_t row = 0; row < window.height; ++row)
        for (std::int64_t column = 0; column < window.width; ++column) {
          const float expected = whole(x + column, y + row), found = part(column, row);
          ASSERT_TRUE(expected == found || (is_void(expected) && is_void(found))) << "level " << level << " at " << x + column << "," << y + row;
        }
    }
  }
}

TEST(ElevationTree, CoarseLevelsLieOverTheFine) {
  const MadeTree made = tree_with_hole();
  const ElevationTree tree = open_tree(made);
  Raster<float> fine(230, 170), coarse(58, 43);
  tree.read(Window{0, 0, 230, 170}, fine.view());
  tree.read_level(2, {0, 0, 58, 43}, coarse.view());
  double sum = 0, count = 0;
  for (std::int64_t y = 0; y < 43; ++y)
    for (std::int64_t x = 0; x < 58; ++x) {
      ASSERT_EQ(is_void(coarse(x, y)), is_void(fine(4 * x, 4 * y))) << x << "," << y;
      if (is_void(coarse(x, y))) continue;
      sum += std::abs(coarse(x, y) - fine(4 * x, 4 * y));
      ++count;
    }
  EXPECT_LT(sum / count, 3);  // low-pass, of relief of 100 m
}

TEST(ElevationTree, DamageIsAnErrorNeverOtherValues) {
  MadeTree made = tree_with_hole();
  Raster<float> whole(230, 170), now(230, 170);
  open_tree(made).read(Window{0, 0, 230, 170}, whole.view());
  int noticed = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    std::byte& byte = made.file[hash_position(9, i) % made.file.size()];
    const std::byte before = byte;
    byte ^= static_cast<std::byte>(1 + hash_position(8, i) % 255);
    try {
      open_tree(made).read(Window{0, 0, 230, 170}, now.view());
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::damaged || error.kind() == ErrorKind::format) << error.what();
      ++noticed;
    }
    byte = before;
  }
  EXPECT_EQ(noticed, 60);
}

}  // namespace
}  // namespace arete
