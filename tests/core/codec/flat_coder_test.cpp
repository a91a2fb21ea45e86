#include "core/codec/flat_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/support/error.h"
#include "core/support/random.h"
#include "tests/core/codec/codec_terrain.h"

namespace arete {
namespace {

// Hills above two lakes, at 412 and at 415, which nearly touch; whole metres.
Raster<double> hills_and_lakes(std::int64_t width, std::int64_t height) {
  const Raster<float> terrain = codec_terrain(width, height);
  Raster<double> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const double left = std::hypot(static_cast<double>(x - width / 3), static_cast<double>(y - height / 2)),
                   right = std::hypot(static_cast<double>(x - 2 * width / 3), static_cast<double>(y - height / 2));
      cells(x, y) = left < 20 ? 412 : right < 20 ? 415 : std::round(terrain(x, y));
    }
  return cells;
}

VoidMask flat_mask(const Raster<double>& cells) {
  return {find_flat_cells(cells.view()), 0, 0};
}

// An error of at most `most` at each place.
Raster<double> with_noise(const Raster<double>& cells, double most) {
  Raster<double> noisy = cells.clone();
  for (std::int64_t i = 0; i < cells.size().cells(); ++i)
    noisy.data()[i] += most * (static_cast<double>(hash_position(7, static_cast<std::uint64_t>(i), 0) % 2001) - 1000) / 1000;
  return noisy;
}

RasterView<const double> block_of(const Raster<double>& cells, const Window& at) {
  return {cells.data() + at.y * cells.width() + at.x, at.width, at.height, cells.width()};
}

template <class Visit>
void for_nodes(const NodeGrid& grid, int level, Visit visit) {
  const Size nodes = grid.nodes(level);
  for (std::int64_t y = 0; y < nodes.height; ++y)
    for (std::int64_t x = 0; x < nodes.width; ++x) visit(NodeAddress{level, x, y});
}

std::int64_t count(const VoidMask& mask) {
  std::int64_t sum = 0;
  for (std::int64_t i = 0; i < mask.cells.size().cells(); ++i) sum += mask.cells.data()[i];
  return sum;
}

// Flat cells come back bit for bit, and nothing else is touched, whatever was decoded.
TEST(FlatCoder, WaterIsExactAndTheRestUntouched) {
  const Raster<double> cells = hills_and_lakes(150, 90), decoded = with_noise(cells, 50);
  const NodeGrid grid(cells.size(), 32);
  const VoidMask fine = flat_mask(cells), coarse = coarsen_voids(fine);
  ASSERT_GT(count(fine), 2000);
  VoidMask again{Raster<std::uint8_t>(150, 90), 0, 0};
  Raster<double> corrected = decoded.clone();
  std::size_t bytes = 0;
  for_nodes(grid, 1, [&](const NodeAddress& node) {
    const std::vector<std::byte> stream = encode_flat(grid, node, coarse, fine, block_of(cells, grid.cells(node)), ValueType::int16);
    bytes += stream.size();
    decode_flat(grid, node, stream, coarse, again, corrected.view(), ValueType::int16, "x");
  });
  EXPECT_LT(bytes, 300U);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) {
    ASSERT_EQ(again.cells.data()[i], fine.cells.data()[i]);
    ASSERT_EQ(corrected.data()[i], fine.cells.data()[i] ? cells.data()[i] : decoded.data()[i]) << i;
  }
}

TEST(FlatCoder, APartOfABlockHasTheValuesOfTheWhole) {
  const Raster<double> cells = hills_and_lakes(64, 64), decoded = with_noise(cells, 1);
  const NodeGrid grid(cells.size(), 64);
  const VoidMask fine = flat_mask(cells), coarse = coarsen_voids(fine);
  const std::vector<std::byte> stream = encode_flat(grid, {1, 0, 0}, coarse, fine, cells.view(), ValueType::float32);
  VoidMask part{Raster<std::uint8_t>(20, 30), 12, 15};
  Raster<double> corrected(20, 30);
  for (std::int64_t y = 0; y < 30; ++y)
    for (std::int64_t x = 0; x < 20; ++x) corrected(x, y) = decoded(x + 12, y + 15);
  decode_flat(grid, {1, 0, 0}, stream, coarse, part, corrected.view(), ValueType::float32, "x");
  for (std::int64_t y = 0; y < 30; ++y)
    for (std::int64_t x = 0; x < 20; ++x) {
      const bool flat = fine.cells(x + 12, y + 15) != 0;
      ASSERT_EQ(corrected(x, y), flat ? cells(x + 12, y + 15) : decoded(x + 12, y + 15));
    }
}

TEST(FlatCoder, CoarserLevelsHaveTheMaskOfTheFinest) {
  const Raster<double> cells = hills_and_lakes(150, 90);
  const NodeGrid grid(cells.size(), 32);
  const VoidMask finest = flat_mask(cells), fine = coarsen_voids(finest), coarse = coarsen_voids(fine);
  VoidMask again{Raster<std::uint8_t>(fine.cells.width(), fine.cells.height()), 0, 0};
  Raster<double> level(fine.cells.width(), fine.cells.height());
  for (std::int64_t y = 0; y < level.height(); ++y)
    for (std::int64_t x = 0; x < level.width(); ++x) level(x, y) = cells(2 * x, 2 * y);
  for_nodes(grid, 2, [&](const NodeAddress& node) {
    const std::vector<std::byte> stream = encode_flat(grid, node, coarse, fine, block_of(level, grid.cells(node)), ValueType::int16);
    decode_flat(grid, node, stream, coarse, again, {}, ValueType::int16, "x");
  });
  for (std::int64_t i = 0; i < fine.cells.size().cells(); ++i) ASSERT_EQ(again.cells.data()[i], fine.cells.data()[i]);
}

// As many values as a block of lakes that touch one another can have.
TEST(FlatCoder, ManyValuesSideBySide) {
  const NodeGrid grid({128, 128}, 128);
  Raster<double> cells(128, 128);
  for (std::int64_t y = 0; y < 128; ++y)
    for (std::int64_t x = 0; x < 128; ++x) cells(x, y) = static_cast<double>(x / 5 * 31 + y / 5 * 7);
  const VoidMask fine = flat_mask(cells), coarse = coarsen_voids(fine);
  EXPECT_GT(count(fine), 128 * 120);
  const std::vector<std::byte> stream = encode_flat(grid, {1, 0, 0}, coarse, fine, cells.view(), ValueType::uint16);
  VoidMask again{Raster<std::uint8_t>(128, 128), 0, 0};
  Raster<double> corrected(128, 128, -1);
  decode_flat(grid, {1, 0, 0}, stream, coarse, again, corrected.view(), ValueType::uint16, "x");
  for (std::int64_t i = 0; i < 128 * 128; ++i) ASSERT_EQ(corrected.data()[i], fine.cells.data()[i] ? cells.data()[i] : -1);
}

TEST(FlatCoder, NumbersThatNoFloatHoldsAreNotWater) {
  Raster<double> cells(12, 12, 5.0);
  cells(6, 6) = 5.0 + 1e-12;
  const Raster<std::uint8_t> flat = find_flat_cells(cells.view());
  EXPECT_EQ(flat(6, 6), 0);
  EXPECT_EQ(flat(2, 2), 1);
}

TEST(FlatCoder, EveryTypeKeepsItsEnds) {
  const NodeGrid grid({32, 32}, 32);
  VoidMask fine{Raster<std::uint8_t>(32, 32, 1), 0, 0};
  const VoidMask coarse = coarsen_voids(fine);
  for (const ValueType type : {ValueType::uint8, ValueType::int16, ValueType::uint16, ValueType::int32, ValueType::uint32, ValueType::float32, ValueType::float64}) {
    const ValueRange range = range_of(type);
    Raster<double> cells(32, 32);
    for (std::int64_t i = 0; i < 1024; ++i) cells.data()[i] = i % 3 == 0 ? range.lowest : i % 3 == 1 ? range.highest : 7;
    const std::vector<std::byte> stream = encode_flat(grid, {1, 0, 0}, coarse, fine, cells.view(), type);
    Raster<double> corrected = cells.clone();
    decode_flat(grid, {1, 0, 0}, stream, coarse, fine, corrected.view(), type, "x");
    for (std::int64_t i = 0; i < 1024; ++i) ASSERT_EQ(corrected.data()[i], cells.data()[i]) << name_of(type);
  }
}

TEST(FlatCoder, NothingFlatCostsNothing) {
  const NodeGrid grid({64, 64}, 64);
  const Raster<double> cells(64, 64, 3.0);
  const VoidMask none{Raster<std::uint8_t>(64, 64, 0), 0, 0};
  const VoidMask coarse = coarsen_voids(none);
  EXPECT_TRUE(encode_flat(grid, {1, 0, 0}, coarse, none, cells.view(), ValueType::int16).empty());
  VoidMask again{Raster<std::uint8_t>(64, 64, 9), 0, 0};
  Raster<double> corrected = cells.clone();
  decode_flat(grid, {1, 0, 0}, {}, coarse, again, corrected.view(), ValueType::int16, "x");
  EXPECT_EQ(count(again), 0);
}

// Each list that breaks a rule is refused; any other bytes give a block whose flat cells have values of the list.
TEST(FlatCoder, IsSafeForAnyBytes) {
  const NodeGrid grid({32, 32}, 32);
  const VoidMask coarse{Raster<std::uint8_t>(16, 16, 1), 0, 0};
  const auto decode = [&](const std::vector<std::uint8_t>& bytes, ValueType type) {
    VoidMask fine{Raster<std::uint8_t>(32, 32), 0, 0};
    Raster<double> cells(32, 32, 0.5);
    decode_flat(grid, {1, 0, 0}, std::as_bytes(std::span(bytes)), coarse, fine, cells.view(), type, "x");
    for (std::int64_t i = 0; i < 1024; ++i) EXPECT_TRUE(fine.cells.data()[i] ? holds(type, cells.data()[i]) : cells.data()[i] == 0.5);
  };
  const std::vector<std::vector<std::uint8_t>> integers = {{0}, {0, 1}, {3, 2, 2}, {1}, {1, 4}, {2, 4}, {1, 0x80, 0x80, 0x04, 9}, {1, 0x81, 0}};
  for (const auto& bytes : integers) EXPECT_THROW(decode(bytes, ValueType::int16), Error) << testing::PrintToString(bytes);
  const std::vector<std::vector<std::uint8_t>> floats = {{1, 0, 0, 0}, {1, 0, 0, 0xc0, 0x7f, 9}, {1, 0, 0, 0x80, 0x7f, 9}, {2, 0, 0, 0, 0x40, 0, 0, 0, 0x40, 9}};
  for (const auto& bytes : floats) EXPECT_THROW(decode(bytes, ValueType::float32), Error) << testing::PrintToString(bytes);
  decode({2, 4, 0, 1, 9}, ValueType::int16);
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    std::vector<std::uint8_t> bytes(hash_position(seed, 1, 1) % 40);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(hash_position(seed, 2, i));
    if (!bytes.empty()) bytes[0] %= 8;
    const ValueType type = *value_type_numbered(static_cast<std::uint8_t>(1 + seed % 7));
    try {
      decode(bytes, type);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::damaged);
    }
  }
}

}  // namespace
}  // namespace arete
