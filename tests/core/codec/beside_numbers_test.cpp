#include "core/codec/beside_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

Raster<double> noisy(std::int64_t width, std::int64_t height) {
  Raster<double> stored(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      stored(x, y) = x + y == 9 ? std::numeric_limits<double>::quiet_NaN() : 700 + uniform_at(7, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
  return stored;
}

const ValueMap by_bits{ValueMap::Kind::double_bits, ValueType::float64, 0, 1, 1, 30};
const ValueMap by_steps{ValueMap::Kind::near_steps, ValueType::float64, 70000, 1, 100};

TEST(BesideNumbers, ComeBackOfEitherKindWithVoids) {
  for (const ValueMap& map : {by_bits, by_steps})
    for (const StreamCells which : {StreamCells::all, StreamCells::off_lattice})
      for (const Size size : {Size{1, 1}, Size{1, 4}, Size{31, 18}}) {
        const Raster<double> stored = noisy(size.width, size.height);
        Raster<std::uint64_t> cells(size.width, size.height);
        for (std::int64_t i = 0; i < size.cells(); ++i) cells.data()[i] = map.beside_of(stored.data()[i]);
        const Raster<std::uint64_t> all = cells.clone();
        for (std::int64_t y = 0; y < size.height; ++y)
          for (std::int64_t x = 0; x < size.width; ++x)
            if (has_number(which, x, y)) cells(x, y) = 1;
        unpack_beside(map, pack_beside(map, stored.view(), which), cells.view(), which, "x");
        for (std::int64_t i = 0; i < size.cells(); ++i) ASSERT_EQ(cells.data()[i], all.data()[i]) << i;
      }
}

TEST(BesideNumbers, OfBitsAreOfOneCount) {
  const std::vector<std::byte> packed = pack_beside(by_bits, noisy(20, 10).view(), StreamCells::off_lattice);
  Raster<std::uint64_t> cells(20, 10, 0);
  EXPECT_THROW(unpack_beside(by_bits, packed, cells.view(), StreamCells::all, "x"), Error);
}

}  // namespace
}  // namespace arete
