#include "core/codec/low_bits.h"

#include <algorithm>

#include "core/codec/byte_stream.h"
#include "core/support/deflate.h"

namespace arete {

std::vector<std::byte> pack_low_bits(std::span<const std::uint64_t> numbers, int bits) {
  if (std::all_of(numbers.begin(), numbers.end(), [](std::uint64_t n) { return n == 0; })) return {};
  std::vector<std::byte> packed((numbers.size() * static_cast<std::size_t>(bits) + 7) / 8);
  std::size_t at = 0;
  for (const std::uint64_t number : numbers)
    for (int i = 0; i < bits; ++i, ++at)
      if ((number >> i) & 1U) packed[at / 8] |= static_cast<std::byte>(1U << (at % 8));
  return deflate_bytes(packed);
}

std::vector<std::uint64_t> unpack_low_bits(std::span<const std::byte> bytes, std::size_t count, int bits, const std::string& name) {
  std::vector<std::uint64_t> numbers(count);
  if (bytes.empty()) return numbers;
  const std::size_t wanted = (count * static_cast<std::size_t>(bits) + 7) / 8;
  const std::vector<std::byte> packed = inflate_bytes(bytes, wanted, name);
  if (packed.size() != wanted) ByteReader({}, name).fail("a node has lower bits for another number of cells");
  std::size_t at = 0;
  for (std::uint64_t& number : numbers)
    for (int i = 0; i < bits; ++i, ++at) number |= static_cast<std::uint64_t>(std::to_integer<unsigned>(packed[at / 8] >> (at % 8)) & 1U) << i;
  return numbers;
}

}  // namespace arete
