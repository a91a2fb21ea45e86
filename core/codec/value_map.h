#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/codec/byte_stream.h"
#include "core/terrain/value_type.h"

namespace arete {

/// How stored numbers become the integers that the predictive coder codes. Back: hold_to(type, (base + n) x numerator / denominator),
/// or, of kind float_bits, the Float32 whose bits, mapped so that larger floats have larger numbers, are base + n.
struct ValueMap {
  enum class Kind : std::uint8_t { steps = 1, float_bits = 2 };
  Kind kind = Kind::steps;
  ValueType type = ValueType::int16;
  std::int64_t base = 0;
  double numerator = 1;
  double denominator = 1;

  /// The stored number of n. Doubles in a fixed order: the same on every machine.
  double value_of(std::int32_t n) const;
  /// The nearest n of a stored number within the range that the map was made for.
  std::int32_t number_of(double value) const;
};

void put_value_map(const ValueMap& map, ByteWriter& out);
/// Safe for untrusted bytes: throws Error{damaged}.
ValueMap get_value_map(ByteReader& in, ValueType type);

/// The stored numbers of a raster; voids are NaN and are passed over.
using StoredValues = std::span<const double>;

/// A map from which every number comes back bit for bit: whole multiples of a common quantum (1, 1/2, 1/4, 1/10, ... 1/10000, feet
/// in metres), else the bits of 32-bit floats. Nullopt where there is none: doubles that no float holds, and no quantum fits.
/// Integers below 2^31 in range always have one. -0.0 is a number of its own, which only float_bits gives back.
std::optional<ValueMap> map_lossless(ValueType type, StoredValues values);

/// A map and the step of the coder (an odd number of n) with which no number is further off than `max_error` after hold_to.
struct BoundedMap {
  ValueMap map;
  std::int32_t step = 1;
};
/// `max_error` > 0, in stored units. Nullopt where the type is too coarse for the bound, or the range too wide for 32 bits.
std::optional<BoundedMap> map_within(ValueType type, StoredValues values, double max_error);

}  // namespace arete
