#include "core/codec/exceptions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/random.h"

namespace arete {
namespace {

constexpr std::uint64_t untouched = 0x5ca1ab1e;

// About one in `every` is a number of as many bits, of either sign.
Raster<std::uint64_t> exceptions_of(Size size, int bits, std::uint64_t every) {
  Raster<std::uint64_t> cells(size.width, size.height, 0);
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    const auto at = static_cast<std::uint64_t>(i);
    if (hash_position(1, at) % every != 0) continue;
    const std::uint64_t number = hash_position(2, at) >> (64 - bits) | std::uint64_t{1} << (bits - 1);
    cells.data()[i] = hash_position(3, at) % 2 != 0 ? 0 - number : number;
  }
  return cells;
}

// What a reader gets that has the lattice already.
Raster<std::uint64_t> unpack(std::span<const std::byte> bytes, const Raster<std::uint64_t>& cells, StreamCells which) {
  Raster<std::uint64_t> read = cells.clone();
  for (std::int64_t y = 0; y < cells.height(); ++y)
    for (std::int64_t x = 0; x < cells.width(); ++x)
      if (has_number(which, x, y)) read(x, y) = untouched;
  unpack_exceptions(bytes, read.view(), which);
  return read;
}

bool equal(const Raster<std::uint64_t>& a, const Raster<std::uint64_t>& b) { return std::equal(a.data(), a.data() + a.size().cells(), b.data()); }

TEST(Exceptions, ComeBackForEveryWidth) {
  for (const StreamCells which : {StreamCells::all, StreamCells::off_lattice})
    for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 9}, Size{37, 22}})
      for (int bits = 1; bits <= 64; ++bits)
        for (const std::uint64_t every : {1, 30}) {
          const Raster<std::uint64_t> cells = exceptions_of(size, bits, every);
          EXPECT_TRUE(equal(unpack(pack_exceptions(cells.view(), which), cells, which), cells)) << bits << " " << every << " " << size.width;
        }
}

TEST(Exceptions, ReachTheEndsOf64Bits) {
  Raster<std::uint64_t> cells(2, 2, 0);
  cells(1, 0) = std::uint64_t{1} << 63;
  cells(0, 1) = std::numeric_limits<std::int64_t>::max();
  cells(1, 1) = std::numeric_limits<std::uint64_t>::max();
  for (const StreamCells which : {StreamCells::all, StreamCells::off_lattice}) EXPECT_TRUE(equal(unpack(pack_exceptions(cells.view(), which), cells, which), cells));
}

TEST(Exceptions, NoneAreNoBytes) {
  const Raster<std::uint64_t> none(70, 50, 0);
  for (const StreamCells which : {StreamCells::all, StreamCells::off_lattice}) EXPECT_TRUE(pack_exceptions(none.view(), which).empty());
  Raster<std::uint64_t> coarser(70, 50, 0);
  coarser(2, 4) = 17;
  EXPECT_TRUE(pack_exceptions(coarser.view(), StreamCells::off_lattice).empty());
  EXPECT_FALSE(pack_exceptions(coarser.view(), StreamCells::all).empty());
}

// Entropy of which cells, by independent draws, and 10 bits each: 9 of a magnitude whose first is known, and the sign.
TEST(Exceptions, CostTheirInformation) {
  const Raster<std::uint64_t> cells = exceptions_of({256, 256}, 10, 32);
  const auto count = static_cast<double>(256 * 256 - std::count(cells.data(), cells.data() + cells.size().cells(), 0U));
  const double share = count / (256 * 256), information = 256 * 256 * (-share * std::log2(share) - (1 - share) * std::log2(1 - share)) + 10 * count;
  EXPECT_LT(static_cast<double>(8 * pack_exceptions(cells.view(), StreamCells::all).size()), 1.06 * information);
}

TEST(Exceptions, AnyBytesGiveNumbersAndLeaveTheLattice) {
  const Raster<std::uint64_t> cells = exceptions_of({19, 14}, 40, 2);
  const std::vector<std::byte> packed = pack_exceptions(cells.view(), StreamCells::off_lattice);
  const auto check = [&](std::span<const std::byte> bytes) {
    const Raster<std::uint64_t> read = unpack(bytes, cells, StreamCells::off_lattice);
    for (std::int64_t y = 0; y < 14; y += 2)
      for (std::int64_t x = 0; x < 19; x += 2) ASSERT_EQ(read(x, y), cells(x, y));
    ASSERT_EQ(std::count(read.data(), read.data() + read.size().cells(), untouched), 0);
  };
  for (std::size_t length = 0; length < packed.size(); ++length) check(std::span(packed).first(length));
  for (std::uint64_t round = 0; round < 200; ++round) {
    std::vector<std::byte> noise(300);
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<std::byte>(hash_position(round, i));
    check(noise);
  }
  check(std::vector<std::byte>(3000, std::byte{0xff}));
}

}  // namespace
}  // namespace arete
