#include "core/codec/beside_numbers.h"

#include "core/codec/low_bits.h"

namespace arete {
namespace {

// The cells of a stream, in its order.
template <class Visit>
void visit_stream(const Size& size, StreamCells which, Visit visit) {
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x)
      if (has_number(which, x, y)) visit(x, y);
}

}  // namespace

std::vector<std::byte> pack_beside(const ValueMap& map, RasterView<const double> stored, StreamCells which) {
  if (map.kind == ValueMap::Kind::near_steps) {
    Raster<std::uint64_t> exceptions(stored.width, stored.height);
    visit_stream(stored.size(), StreamCells::all, [&](std::int64_t x, std::int64_t y) { exceptions(x, y) = map.beside_of(stored(x, y)); });
    return pack_exceptions(exceptions.view(), which);
  }
  std::vector<std::uint64_t> low;
  visit_stream(stored.size(), which, [&](std::int64_t x, std::int64_t y) { low.push_back(map.beside_of(stored(x, y))); });
  return pack_low_bits(low, map.low_bits);
}

void unpack_beside(const ValueMap& map, std::span<const std::byte> bytes, RasterView<std::uint64_t> cells, StreamCells which, const std::string& name) {
  if (map.kind == ValueMap::Kind::near_steps) return unpack_exceptions(bytes, cells, which);
  std::size_t count = 0;
  visit_stream(cells.size(), which, [&](std::int64_t, std::int64_t) { ++count; });
  const std::vector<std::uint64_t> low = unpack_low_bits(bytes, count, map.low_bits, name);
  visit_stream(cells.size(), which, [&, next = std::size_t{0}](std::int64_t x, std::int64_t y) mutable { cells(x, y) = low[next++]; });
}

}  // namespace arete
