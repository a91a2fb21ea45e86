#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace arete {

/// How a file stores one elevation. The numbers are part of file formats: never change them. A double holds every value of each.
enum class ValueType : std::uint8_t { uint8 = 1, int16 = 2, uint16 = 3, int32 = 4, uint32 = 5, float32 = 6, float64 = 7 };

/// The lowest and the highest finite value.
struct ValueRange {
  double lowest = 0;
  double highest = 0;
};

/// GDAL's name: "Byte", "Int16", "UInt16", "Int32", "UInt32", "Float32", "Float64".
std::string_view name_of(ValueType type);
/// The type of that name, or nullopt.
std::optional<ValueType> value_type_named(std::string_view name);
/// The type of that number in a file, or nullopt where it is none.
std::optional<ValueType> value_type_numbered(std::uint8_t number);

constexpr bool is_integer(ValueType type) { return type < ValueType::float32; }

constexpr int bytes_of(ValueType type) {
  switch (type) {
    case ValueType::uint8: return 1;
    case ValueType::int16:
    case ValueType::uint16: return 2;
    case ValueType::int32:
    case ValueType::uint32:
    case ValueType::float32: return 4;
    case ValueType::float64: break;
  }
  return 8;
}

constexpr ValueRange range_of(ValueType type) {
  switch (type) {
    case ValueType::uint8: return {0, 255};
    case ValueType::int16: return {-32768, 32767};
    case ValueType::uint16: return {0, 65535};
    case ValueType::int32: return {-2147483648.0, 2147483647.0};
    case ValueType::uint32: return {0, 4294967295.0};
    case ValueType::float32: return {-std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
    case ValueType::float64: break;
  }
  return {-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
}

/// The value of the type that lies nearest: halves of integers go away from zero (an integer is never -0), floats are rounded to
/// even; beyond the range, infinities included, the end of the range. NaN, a void, stays NaN for every type.
inline double hold_to(ValueType type, double value) {
  if (std::isnan(value)) return value;
  const ValueRange range = range_of(type);
  const double inside = std::clamp(value, range.lowest, range.highest);
  if (is_integer(type)) return std::round(inside) + 0.0;
  return type == ValueType::float32 ? static_cast<double>(static_cast<float>(inside)) : inside;
}

/// The next value of the type, away from the subnormal numbers, which some readers take for zero: above it, but below the highest.
double next_value(ValueType type, double value);

/// Whether the type holds exactly this value; NaN and infinities are held by the floats.
inline bool holds(ValueType type, double value) {
  if (!std::isfinite(value)) return !is_integer(type);
  return hold_to(type, value) == value;
}

}  // namespace arete
