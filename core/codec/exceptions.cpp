#include "core/codec/exceptions.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/codec/bit_coding.h"

namespace arete {
namespace {

constexpr int most_bits = 64;
constexpr int reach = 6;           // cells that a context looks at to each side
constexpr int densities = 5;       // that it tells apart in a row or a column
constexpr std::size_t known = 32;  // digits behind fewer than this have models

struct ExceptionModels {
  std::array<BitModel, 4 * densities * densities> exact;
  BitModel sign;
  std::array<BitModel, most_bits> length;
  std::array<std::array<BitModel, known>, most_bits + 1> digits;
};

// Which cells are exceptions, as far as is known; with a border of cells that are none.
class Flags {
 public:
  Flags(RasterView<const std::uint64_t> cells, StreamCells which) : flags_(cells.width + 2 * reach, cells.height + 2 * reach, 0) {
    if (which == StreamCells::all) return;
    for (std::int64_t y = 0; y < cells.height; y += 2)
      for (std::int64_t x = 0; x < cells.width; x += 2) set(x, y, cells(x, y) != 0);
  }
  void set(std::int64_t x, std::int64_t y, bool flag) { flags_(x + reach, y + reach) = flag; }
  // The place in a square of 2 x 2 cells and how many there are near in the row and in the column: exceptions gather along seams.
  std::size_t context(std::int64_t x, std::int64_t y) const {
    const std::uint8_t* const at = &flags_(x + reach, y + reach);
    const std::int64_t place = 2 * (y % 2) + x % 2;
    return static_cast<std::size_t>((place * densities + density(at, 1)) * densities + density(at, flags_.width()));
  }

 private:
  static int density(const std::uint8_t* at, std::int64_t stride) {
    int count = 0;
    for (std::int64_t i = 1; i <= reach; ++i) count += at[-i * stride] + at[i * stride];
    return count < 3 ? count : count < 5 ? 3 : 4;
  }
  Raster<std::uint8_t> flags_;
};

// A number other than 0.
template <class Bits>
std::uint64_t code_exception(Bits& bits, ExceptionModels& models, std::uint64_t number) {
  const bool negative = code_modelled(bits, models.sign, static_cast<int>(number >> 63)) != 0;
  const std::uint64_t size = number >> 63 ? 0 - number : number;
  const int wanted = static_cast<int>(std::bit_width(size));
  int length = 1;
  while (length < most_bits && code_modelled(bits, models.length[static_cast<std::size_t>(length)], wanted > length)) ++length;
  std::uint64_t coded = 1;
  for (int i = length - 2; i >= 0; --i) {
    const int bit = static_cast<int>((size >> i) & 1U);
    coded = 2 * coded + static_cast<std::uint64_t>(coded < known ? code_modelled(bits, models.digits[static_cast<std::size_t>(length)][coded], bit) : bits(bit, 1U << 15));
  }
  return negative ? 0 - coded : coded;
}

// `number_at` gives the number to code, `set` takes the one that was.
template <class Bits, class NumberAt, class Set>
void code_cells(Bits bits, RasterView<const std::uint64_t> cells, StreamCells which, NumberAt number_at, Set set) {
  ExceptionModels models;
  Flags flags(cells, which);
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) {
      if (!has_number(which, x, y)) continue;
      const std::uint64_t number = number_at(x, y);
      // 1 for 0: what a stream of no bytes says of every cell.
      const bool exact = code_modelled(bits, models.exact[flags.context(x, y)], number == 0) != 0;
      flags.set(x, y, !exact);
      set(x, y, exact ? 0 : code_exception(bits, models, number));
    }
}

}  // namespace

std::vector<std::byte> pack_exceptions(RasterView<const std::uint64_t> cells, StreamCells which) {
  RangeEncoder coder;
  code_cells(EncodingBits{coder}, cells, which, [&](std::int64_t x, std::int64_t y) { return cells(x, y); }, [](std::int64_t, std::int64_t, std::uint64_t) {});
  return coder.finish();
}

void unpack_exceptions(std::span<const std::byte> bytes, RasterView<std::uint64_t> cells, StreamCells which) {
  RangeDecoder coder(bytes);
  code_cells(DecodingBits{coder}, cells, which, [](std::int64_t, std::int64_t) { return std::uint64_t{0}; },
             [&](std::int64_t x, std::int64_t y, std::uint64_t number) { cells(x, y) = number; });
}

}  // namespace arete
