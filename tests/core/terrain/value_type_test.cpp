#include "core/terrain/value_type.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace arete {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr ValueType every_type[] = {ValueType::uint8,  ValueType::int16,   ValueType::uint16, ValueType::int32,
                                    ValueType::uint32, ValueType::float32, ValueType::float64};

/// The compiler's own types are the authority.
template <typename T>
void expect_type(ValueType type) {
  using limits = std::numeric_limits<T>;
  EXPECT_EQ(range_of(type).lowest, static_cast<double>(limits::lowest()));
  EXPECT_EQ(range_of(type).highest, static_cast<double>(limits::max()));
  EXPECT_EQ(bytes_of(type), static_cast<int>(sizeof(T)));
  EXPECT_EQ(is_integer(type), limits::is_integer);
}

TEST(ValueType, HasTheRangeAndTheBytesOfTheMachinesType) {
  expect_type<std::uint8_t>(ValueType::uint8);
  expect_type<std::int16_t>(ValueType::int16);
  expect_type<std::uint16_t>(ValueType::uint16);
  expect_type<std::int32_t>(ValueType::int32);
  expect_type<std::uint32_t>(ValueType::uint32);
  expect_type<float>(ValueType::float32);
  expect_type<double>(ValueType::float64);
}

TEST(ValueType, NamesAndNumbersLeadBack) {
  for (const ValueType type : every_type) {
    EXPECT_EQ(value_type_named(name_of(type)), type);
    EXPECT_EQ(value_type_numbered(static_cast<std::uint8_t>(type)), type);
  }
  EXPECT_EQ(name_of(ValueType::uint8), "Byte");
  EXPECT_EQ(name_of(ValueType::float64), "Float64");
  EXPECT_EQ(static_cast<int>(ValueType::float64), 7);
  for (const char* name : {"", "byte", "Int64", "CFloat32"}) EXPECT_EQ(value_type_named(name), std::nullopt);
  for (const int number : {0, 8, 255}) EXPECT_EQ(value_type_numbered(static_cast<std::uint8_t>(number)), std::nullopt);
}

TEST(ValueType, HoldsToTheNearestValue) {
  EXPECT_EQ(hold_to(ValueType::int16, 2.5), 3);
  EXPECT_EQ(hold_to(ValueType::int16, -2.5), -3);
  EXPECT_EQ(hold_to(ValueType::int16, 2.4999999999999996), 2);
  EXPECT_EQ(hold_to(ValueType::int16, 1e9), 32767);
  EXPECT_EQ(hold_to(ValueType::int16, -inf), -32768);
  EXPECT_EQ(hold_to(ValueType::uint8, -0.4), 0);
  EXPECT_FALSE(std::signbit(hold_to(ValueType::uint8, -0.4)));
  EXPECT_EQ(hold_to(ValueType::uint32, 4294967294.6), 4294967295.0);
  EXPECT_EQ(hold_to(ValueType::int32, -2147483648.9), -2147483648.0);
  EXPECT_EQ(hold_to(ValueType::float32, 0.1), static_cast<double>(0.1F));
  EXPECT_EQ(hold_to(ValueType::float32, 1 + std::ldexp(1.0, -24)), 1);  // a tie goes to the even float
  EXPECT_EQ(hold_to(ValueType::float32, 1e39), static_cast<double>(std::numeric_limits<float>::max()));
  EXPECT_EQ(hold_to(ValueType::float64, inf), std::numeric_limits<double>::max());
  EXPECT_TRUE(std::signbit(hold_to(ValueType::float32, -0.0)));
  EXPECT_EQ(hold_to(ValueType::float32, std::ldexp(1.0, -149)), std::ldexp(1.0, -149));
  for (const ValueType type : every_type) EXPECT_TRUE(std::isnan(hold_to(type, nan)));
}

TEST(ValueType, HoldingIsIdempotentAndMonotone) {
  std::vector<double> ladder;
  for (int i = -80; i <= 80; ++i) ladder.push_back(std::copysign(std::pow(1.7, std::abs(i)) - 1, i) + 0.37 * (i % 3));
  std::sort(ladder.begin(), ladder.end());
  for (const ValueType type : every_type) {
    double before = -inf;
    for (const double value : ladder) {
      const double held = hold_to(type, value);
      EXPECT_EQ(hold_to(type, held), held);
      EXPECT_TRUE(holds(type, held));
      EXPECT_GE(held, before);
      before = held;
    }
  }
}

TEST(ValueType, TheNextValueIsAnotherOfTheTypeWithNoneBetween) {
  for (const ValueType type : every_type) {
    const ValueRange range = range_of(type);
    for (const double value : {range.lowest, 0.0, 100.0, range.highest}) {
      const double next = next_value(type, value);
      EXPECT_TRUE(holds(type, next));
      EXPECT_NE(next, value);
      EXPECT_EQ(next < value, value == range.highest);
      // Halfway is held to one of the two; zero's neighbours are subnormal numbers.
      if (value != 0 || is_integer(type)) {
        const double between = hold_to(type, value / 2 + next / 2);
        EXPECT_TRUE(between == value || between == next) << name_of(type) << " " << value;
      }
    }
  }
  EXPECT_EQ(next_value(ValueType::float32, 0), 0x1p-126);
}

TEST(ValueType, KnowsWhatItHolds) {
  EXPECT_TRUE(holds(ValueType::int16, -9999));
  EXPECT_FALSE(holds(ValueType::uint8, -9999));
  EXPECT_FALSE(holds(ValueType::int32, 0.5));
  EXPECT_FALSE(holds(ValueType::float32, 0.1));
  EXPECT_TRUE(holds(ValueType::float64, 0.1));
  EXPECT_FALSE(holds(ValueType::int16, nan));
  EXPECT_FALSE(holds(ValueType::uint32, inf));
  EXPECT_TRUE(holds(ValueType::float32, nan));
}

}  // namespace
}  // namespace arete
