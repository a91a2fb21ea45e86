#include "core/codec/void_mask_coder.h"

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

VoidMask disc_mask(std::int64_t width, std::int64_t height) {
  VoidMask mask{Raster<std::uint8_t>(width, height), 0, 0};
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      mask.cells(x, y) = (x - 40) * (x - 40) + (y - 30) * (y - 30) < 500 || hash_position(1, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) % 97 == 0;
  return mask;
}

TEST(VoidMaskCoder, GivesBackEveryNode) {
  const VoidMask fine = disc_mask(101, 75);
  const VoidMask coarse = coarsen_voids(fine);
  const NodeGrid grid(fine.cells.size(), 32);
  VoidMask again{Raster<std::uint8_t>(101, 75, 9), 0, 0};
  std::size_t bytes = 0;
  for (std::int64_t y = 0; y < grid.nodes(1).height; ++y)
    for (std::int64_t x = 0; x < grid.nodes(1).width; ++x) {
      const std::vector<std::byte> stream = encode_voids(grid, {1, x, y}, coarse, fine);
      bytes += stream.size();
      decode_voids(grid, {1, x, y}, stream, coarse, again);
    }
  for (std::int64_t i = 0; i < fine.cells.size().cells(); ++i) ASSERT_EQ(again.cells.data()[i], fine.cells.data()[i]) << i;
  EXPECT_LT(bytes, 101U * 75 / 8);  // less than a bit a cell
}

TEST(VoidMaskCoder, NothingVoidCostsNothing) {
  const VoidMask fine{Raster<std::uint8_t>(64, 64, 0), 0, 0};
  EXPECT_TRUE(encode_voids(NodeGrid({64, 64}, 64), {1, 0, 0}, coarsen_voids(fine), fine).empty());
}

TEST(VoidMaskCoder, RootComesBack) {
  const VoidMask root = coarsen_voids(disc_mask(13, 15));
  const VoidMask again = decode_root_voids(encode_root_voids(root), root.cells.size(), "x");
  for (std::int64_t i = 0; i < root.cells.size().cells(); ++i) EXPECT_EQ(again.cells.data()[i], root.cells.data()[i]);
  EXPECT_THROW(decode_root_voids({}, root.cells.size(), "x"), Error);
}

}  // namespace
}  // namespace arete
