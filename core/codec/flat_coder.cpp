#include "core/codec/flat_coder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "core/codec/bit_model.h"
#include "core/codec/byte_stream.h"
#include "core/codec/range_coder.h"
#include "core/codec/stream_parts.h"
#include "core/terrain/flat_water.h"

namespace arete {
namespace {

constexpr unsigned adaptation_limit = 250;

// Visits the flat cells of the block: visit(x, y), counted in the block.
template <class Visit>
void visit_flat(const NodeGrid& grid, const NodeAddress& node, const VoidMask& fine, Visit visit) {
  const Window at = grid.cells(node);
  for (std::int64_t y = 0; y < at.height; ++y)
    for (std::int64_t x = 0; x < at.width; ++x)
      if (fine.cells(at.x + x - fine.x, at.y + y - fine.y) != 0) visit(x, y);
}

// The values of the flat cells of a block, rising, -0 as 0.
std::vector<double> list_values(const NodeGrid& grid, const NodeAddress& node, RasterView<const double> values, const VoidMask& fine) {
  std::set<double> found;
  visit_flat(grid, node, fine, [&](std::int64_t x, std::int64_t y) { found.insert(values(x, y) + 0.0); });
  return {found.begin(), found.end()};
}

// Which value of the list each flat cell of a block has, cell by cell: as its neighbour to the left, else as the one above, or told in
// `width` bits. code(model, bit) and raw(index) code or ignore what they are given, and give what was coded.
template <class Code, class Raw>
void code_indexes(const Raster<std::uint8_t>& flat, Raster<std::int32_t>& indexes, Code code, Raw raw) {
  BitModel beside, below;
  for (std::int64_t y = 0; y < flat.height(); ++y)
    for (std::int64_t x = 0; x < flat.width(); ++x) {
      if (flat(x, y) == 0) continue;
      const bool left = x > 0 && flat(x - 1, y) != 0, above = y > 0 && flat(x, y - 1) != 0;
      const std::int32_t expected = left ? indexes(x - 1, y) : above ? indexes(x, y - 1) : 0;
      if ((left || above) && code(left ? beside : below, indexes(x, y) == expected)) indexes(x, y) = expected;
      else indexes(x, y) = raw(indexes(x, y));
    }
}

Raster<std::uint8_t> block_of(const NodeGrid& grid, const NodeAddress& node, const VoidMask& fine) {
  const Window at = grid.cells(node);
  Raster<std::uint8_t> block(at.width, at.height);
  for (std::int64_t y = 0; y < at.height; ++y) std::copy_n(fine.cells.view().row(at.y + y - fine.y) + (at.x - fine.x), at.width, block.view().row(y));
  return block;
}

Probability held(const BitModel& model) { return std::clamp<Probability>(model.p(), 16, 65520); }

std::vector<std::byte> encode_indexes(const Raster<std::uint8_t>& flat, RasterView<const double> values, const std::vector<double>& list) {
  Raster<std::int32_t> indexes(flat.width(), flat.height());
  for (std::int64_t y = 0; y < flat.height(); ++y)
    for (std::int64_t x = 0; x < flat.width(); ++x)
      if (flat(x, y) != 0) indexes(x, y) = static_cast<std::int32_t>(std::lower_bound(list.begin(), list.end(), values(x, y)) - list.begin());
  RangeEncoder encoder;
  const int width = std::bit_width(list.size() - 1);
  code_indexes(
      flat, indexes,
      [&](BitModel& model, bool same) {
        encoder.encode(same, held(model));
        model.update(same, adaptation_limit);
        return same;
      },
      [&](std::int32_t index) {
        encoder.encode_raw(static_cast<std::uint32_t>(index), width);
        return index;
      });
  return encoder.finish();
}

Raster<std::int32_t> decode_indexes(const Raster<std::uint8_t>& flat, std::span<const std::byte> bytes, std::size_t count) {
  Raster<std::int32_t> indexes(flat.width(), flat.height(), 0);
  if (count == 1) return indexes;
  RangeDecoder decoder(bytes);
  const int width = std::bit_width(count - 1);
  code_indexes(
      flat, indexes,
      [&](BitModel& model, bool) {
        const int same = decoder.decode(held(model));
        model.update(same, adaptation_limit);
        return same != 0;
      },
      [&](std::int32_t) { return static_cast<std::int32_t>(std::min<std::uint32_t>(decoder.decode_raw(width), static_cast<std::uint32_t>(count - 1))); });
  return indexes;
}

// --- lists as bytes: integers by their differences, floats as they are

void put_list(ByteWriter& out, const std::vector<double>& list, ValueType type) {
  out.put_varint(list.size());
  std::int64_t last = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (type == ValueType::float32) {
      out.put(static_cast<float>(list[i]));
    } else if (type == ValueType::float64) {
      out.put(list[i]);
    } else {
      const auto whole = static_cast<std::int64_t>(list[i]), step = whole - last;
      out.put_varint(static_cast<std::uint64_t>(i > 0 ? step - 1 : step < 0 ? -2 * step - 1 : 2 * step));
      last = whole;
    }
  }
}

std::vector<double> get_list(ByteReader& in, ValueType type) {
  constexpr std::uint64_t widest = std::uint64_t{1} << 33;  // any difference of two 32-bit integers, folded
  const std::uint64_t count = in.get_varint(most_flat_values, "the number of flat values");
  if (count == 0 || count > in.left()) in.fail("a list of flat values is empty, or longer than its bytes");
  std::vector<double> list(count);
  std::int64_t last = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (is_integer(type)) {
      const auto number = static_cast<std::int64_t>(in.get_varint(widest, "a flat value"));
      last += i > 0 ? number + 1 : number % 2 != 0 ? -(number / 2) - 1 : number / 2;
      list[i] = static_cast<double>(last);
    } else {
      list[i] = type == ValueType::float32 ? static_cast<double>(in.get<float>()) : in.get<double>();
    }
    if (!std::isfinite(list[i]) || !holds(type, list[i]) || (i > 0 && !(list[i] > list[i - 1]))) in.fail("its flat values are not rising numbers of its type");
  }
  return list;
}

}  // namespace

Raster<std::uint8_t> find_flat_cells(RasterView<const double> values) {
  Raster<float> floats(values.width, values.height);
  for (std::int64_t y = 0; y < values.height; ++y)
    for (std::int64_t x = 0; x < values.width; ++x) floats(x, y) = static_cast<float>(values(x, y));
  Raster<std::uint8_t> flat = find_flat_water(floats.view());
  for (std::int64_t y = 0; y < values.height; ++y)
    for (std::int64_t x = 0; x < values.width; ++x)
      if (static_cast<double>(floats(x, y)) != values(x, y)) flat(x, y) = 0;
  return flat;
}

std::vector<std::byte> encode_flat(const NodeGrid& grid, const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine,
                                   RasterView<const double> values, ValueType type) {
  const std::vector<std::byte> mask = encode_voids(grid, node, coarse, fine);
  if (mask.empty()) return {};
  const std::vector<double> list = list_values(grid, node, values, fine);
  ByteWriter out;
  put_list(out, list, type);
  out.put_bytes(list.size() == 1 ? mask : join_parts({mask, encode_indexes(block_of(grid, node, fine), values, list)}));
  return out.take();
}

void decode_flat(const NodeGrid& grid, const NodeAddress& node, std::span<const std::byte> bytes, const VoidMask& coarse, VoidMask& fine,
                 RasterView<double> decoded, ValueType type, const std::string& name) {
  if (bytes.empty()) return decode_voids(grid, node, bytes, coarse, fine);
  ByteReader in(bytes, name);
  const std::vector<double> list = get_list(in, type);
  const std::span<const std::byte> left = bytes.last(in.left());
  StreamParts parts = list.size() == 1 ? StreamParts{{left.begin(), left.end()}, {}} : split_parts(left, name);
  if (parts.first.empty()) in.fail("a list of flat values has no mask");
  const Window at = grid.cells(node);
  VoidMask block{Raster<std::uint8_t>(at.width, at.height), at.x, at.y};
  decode_voids(grid, node, parts.first, coarse, block);
  const Raster<std::int32_t> indexes = decoded.data == nullptr ? Raster<std::int32_t>() : decode_indexes(block.cells, parts.rest, list.size());
  const std::int64_t x0 = std::max(at.x, fine.x), x1 = std::min(at.x + at.width, fine.x + fine.cells.width());
  const std::int64_t y0 = std::max(at.y, fine.y), y1 = std::min(at.y + at.height, fine.y + fine.cells.height());
  for (std::int64_t y = y0; y < y1; ++y)
    for (std::int64_t x = x0; x < x1; ++x) {
      const std::uint8_t flat = fine.cells(x - fine.x, y - fine.y) = block.cells(x - at.x, y - at.y);
      if (flat != 0 && decoded.data != nullptr) decoded(x - fine.x, y - fine.y) = list[static_cast<std::size_t>(indexes(x - at.x, y - at.y))];
    }
}

}  // namespace arete
