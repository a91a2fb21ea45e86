#include "core/terrain/value_type.h"

#include <array>

namespace arete {
namespace {

// In the order of their numbers, which count from 1.
constexpr std::array<std::string_view, 7> names = {"Byte", "Int16", "UInt16", "Int32", "UInt32", "Float32", "Float64"};

}  // namespace

std::string_view name_of(ValueType type) { return names[static_cast<std::size_t>(type) - 1]; }

std::optional<ValueType> value_type_named(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<ValueType>(i + 1);
  return std::nullopt;
}

std::optional<ValueType> value_type_numbered(std::uint8_t number) {
  if (number < 1 || number > names.size()) return std::nullopt;
  return static_cast<ValueType>(number);
}

double next_value(ValueType type, double value) {
  if (value == range_of(type).highest) return -next_value(type, -value);
  if (is_integer(type)) return value + 1;
  if (type == ValueType::float64) return value == 0 ? std::numeric_limits<double>::min() : std::nextafter(value, std::numeric_limits<double>::max());
  const auto number = static_cast<float>(value);
  return static_cast<double>(number == 0 ? std::numeric_limits<float>::min() : std::nextafterf(number, std::numeric_limits<float>::max()));
}

}  // namespace arete
