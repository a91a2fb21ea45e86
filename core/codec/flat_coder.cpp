#include "core/codec/flat_coder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "core/codec/byte_stream.h"

namespace arete {
namespace {

// Visits the flat cells of the block: visit(x, y), counted in the block.
template <class Visit>
void visit_flat(const NodeGrid& grid, const NodeAddress& node, const VoidMask& fine, Visit visit) {
  const Window at = grid.cells(node);
  for (std::int64_t y = 0; y < at.height; ++y)
    for (std::int64_t x = 0; x < at.width; ++x)
      if (fine.cells(at.x + x - fine.x, at.y + y - fine.y) != 0) visit(x, y);
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

// The values of the flat cells of a block, rising, -0 as 0; of more than most_flat_values those that most cells have, of equally many the lowest.
std::vector<double> list_values(const NodeGrid& grid, const NodeAddress& node, RasterView<const double> values, const VoidMask& fine) {
  std::map<double, std::int64_t> counts;
  visit_flat(grid, node, fine, [&](std::int64_t x, std::int64_t y) { ++counts[values(x, y) + 0.0]; });
  std::vector<std::pair<std::int64_t, double>> order;
  for (const auto& [value, count] : counts) order.emplace_back(-count, value);
  std::sort(order.begin(), order.end());
  order.resize(std::min<std::size_t>(order.size(), most_flat_values));
  std::vector<double> list;
  for (const auto& entry : order) list.push_back(entry.second);
  std::sort(list.begin(), list.end());
  return list;
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
  std::vector<double> list(static_cast<std::size_t>(in.get_varint(most_flat_values, "the number of flat values")));
  if (list.empty()) in.fail("a list of flat values is empty");
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

double nearest_flat(std::span<const double> list, double decoded) {
  double nearest = list.front(), distance = std::abs(decoded - nearest);
  for (const double value : list.subspan(1)) {
    const double d = std::abs(decoded - value);
    if (d < distance) nearest = value, distance = d;
  }
  return nearest;
}

void keep_reached(const NodeGrid& grid, const NodeAddress& node, RasterView<const double> values, RasterView<const double> decoded, VoidMask& fine) {
  const Window at = grid.cells(node);
  // The list of what stays may be shorter than that of what was there: then the nearest of a cell that stays is still its own.
  const std::vector<double> list = list_values(grid, node, values, fine);
  if (list.empty()) return;
  visit_flat(grid, node, fine, [&](std::int64_t x, std::int64_t y) {
    if (!same_bits(nearest_flat(list, decoded(x, y)), values(x, y))) fine.cells(at.x + x - fine.x, at.y + y - fine.y) = 0;
  });
}

std::vector<std::byte> encode_flat(const NodeGrid& grid, const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine,
                                   RasterView<const double> values, ValueType type) {
  const std::vector<std::byte> mask = encode_voids(grid, node, coarse, fine);
  if (mask.empty()) return {};
  ByteWriter out;
  put_list(out, list_values(grid, node, values, fine), type);
  out.put_bytes(mask);
  return out.take();
}

void decode_flat(const NodeGrid& grid, const NodeAddress& node, std::span<const std::byte> bytes, const VoidMask& coarse, VoidMask& fine,
                 RasterView<double> decoded, ValueType type, const std::string& name) {
  if (bytes.empty()) return decode_voids(grid, node, bytes, coarse, fine);
  ByteReader in(bytes, name);
  const std::vector<double> list = get_list(in, type);
  if (in.left() == 0) in.fail("a list of flat values has no mask");
  decode_voids(grid, node, bytes.last(in.left()), coarse, fine);
  if (decoded.data == nullptr) return;
  const Window at = grid.cells(node);
  const std::int64_t x0 = std::max(at.x, fine.x), x1 = std::min(at.x + at.width, fine.x + fine.cells.width());
  const std::int64_t y0 = std::max(at.y, fine.y), y1 = std::min(at.y + at.height, fine.y + fine.cells.height());
  for (std::int64_t y = y0; y < y1; ++y)
    for (std::int64_t x = x0; x < x1; ++x)
      if (fine.cells(x - fine.x, y - fine.y) != 0) decoded(x - fine.x, y - fine.y) = nearest_flat(list, decoded(x - fine.x, y - fine.y));
}

}  // namespace arete
