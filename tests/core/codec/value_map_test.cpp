#include "core/codec/value_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

ValueSurvey survey(ValueType type, const std::vector<double>& values) {
  StoredRange range;
  range.add(values);
  ValueSurvey found(type, range);
  // In two parts, as a raster comes.
  const std::size_t half = values.size() / 2;
  found.add(StoredValues(values).first(half));
  found.add(StoredValues(values).subspan(half));
  return found;
}

std::optional<ValueMap> map_lossless(ValueType type, const std::vector<double>& values) { return survey(type, values).lossless(); }

std::optional<BoundedMap> map_within(ValueType type, const std::vector<double>& values, double max_error) {
  return arete::map_within(survey(type, values), max_error);
}

void expect_lossless(const ValueMap& map, const std::vector<double>& values) {
  for (double value : values) {
    if (std::isnan(value)) continue;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(map.value_of(map.number_of(value))), std::bit_cast<std::uint64_t>(value)) << value;
  }
}

TEST(ValueMap, IntegersAreTheirOwnNumbers) {
  const std::vector<double> values{-32768, 0, 17, none, 32767};
  const std::optional<ValueMap> map = map_lossless(ValueType::int16, values);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->numerator, 1);
  expect_lossless(*map, values);
}

TEST(ValueMap, FindsWholeCentimetresInFloats) {
  std::vector<double> values{none};
  for (int n = 18790; n < 30728; n += 13) values.push_back(static_cast<float>(n / 100.0));
  const std::optional<ValueMap> map = map_lossless(ValueType::float32, values);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->kind, ValueMap::Kind::steps);
  EXPECT_EQ(map->denominator, 100);
  expect_lossless(*map, values);
}

TEST(ValueMap, OtherFloatsGoByTheirBits) {
  std::vector<double> values{0.0, -0.0, std::numeric_limits<float>::denorm_min(), -std::numeric_limits<float>::denorm_min(), 1e30F, -3.3e-12F};
  for (std::uint64_t i = 0; i < 100; ++i) values.push_back(static_cast<float>(1300 + uniform_at(1, i)));
  const std::optional<ValueMap> map = map_lossless(ValueType::float32, values);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->kind, ValueMap::Kind::float_bits);
  expect_lossless(*map, values);
}

TEST(ValueMap, DoublesThatAreFloatsOrQuantised) {
  expect_lossless(*map_lossless(ValueType::float64, std::vector<double>{1.5F, 0.1F, 1e-20F}), {1.5F, 0.1F, 1e-20F});
  expect_lossless(*map_lossless(ValueType::float64, std::vector<double>{0.1, 0.2, 1234.7}), {0.1, 0.2, 1234.7});
}

TEST(ValueMap, OtherDoublesGoByTheirBitsInTwoParts) {
  std::vector<std::vector<double>> cases{{0.1, M_PI}, {-1e300, 1e-310, 5e300}, {-0.0, M_PI, 0.0}, {std::numeric_limits<double>::lowest(), M_E, std::numeric_limits<double>::max()}};
  cases.emplace_back();
  for (std::uint64_t i = 0; i < 100; ++i) cases.back().push_back(1300 + uniform_at(1, i));
  for (const std::vector<double>& values : cases) {
    const std::optional<ValueMap> map = map_lossless(ValueType::float64, values);
    ASSERT_TRUE(map);
    EXPECT_EQ(map->kind, ValueMap::Kind::double_bits);
    EXPECT_LE(map->low_bits, ValueMap::greatest_low_bits);
    for (double value : values) EXPECT_EQ(std::bit_cast<std::uint64_t>(map->value_of(map->number_of(value), map->beside_of(value))), std::bit_cast<std::uint64_t>(value)) << value;
  }
  EXPECT_EQ(map_lossless(ValueType::float64, {1e-310, 2e-310, M_PI})->beside_of(none), 0U);
}

// Whole centimetres, but for every 30th number.
std::vector<double> nearly_centimetres(ValueType type) {
  std::vector<double> values;
  for (std::uint64_t i = 0; i < 6000; ++i) {
    const double z = -20 + 300 * uniform_at(4, i), whole = std::round(z * 100) / 100;
    values.push_back(hold_to(type, i % 30 == 5 ? z : whole));
  }
  return values;
}

TEST(ValueMap, FindsTheQuantumOfMostFloatsAndKeepsTheOthersBeside) {
  for (const ValueType type : {ValueType::float32, ValueType::float64}) {
    std::vector<double> values = nearly_centimetres(type);
    for (double other : {-0.0, 0.0, 1e-30, -1e-30, 0.005, -0.005}) values.push_back(hold_to(type, other));
    values.push_back(type == ValueType::float32 ? std::numeric_limits<float>::denorm_min() : std::numeric_limits<double>::denorm_min());
    const std::optional<ValueMap> map = survey(type, values).nearly_quantised();
    ASSERT_TRUE(map);
    EXPECT_EQ(map->kind, ValueMap::Kind::near_steps);
    EXPECT_EQ(map->denominator, 100);
    for (double value : values)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(map->value_of(map->number_of(value), map->beside_of(value))), std::bit_cast<std::uint64_t>(value)) << value;
    const auto exact = std::count_if(values.begin(), values.end(), [&](double value) { return map->beside_of(value) == 0; });
    EXPECT_GT(static_cast<double>(exact), 0.96 * static_cast<double>(values.size()));
    EXPECT_EQ(map->beside_of(none), 0U);
  }
}

TEST(ValueMap, NothingIsNearAQuantumWhereOneFitsAllOrNone) {
  std::vector<double> whole, noise;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    noise.push_back(static_cast<float>(uniform_at(1, i)));
    whole.push_back(static_cast<float>(std::round(noise.back() * 1000) / 100));
  }
  EXPECT_FALSE(survey(ValueType::float32, whole).nearly_quantised());
  EXPECT_FALSE(survey(ValueType::float32, noise).nearly_quantised());
  EXPECT_FALSE(survey(ValueType::int16, {1, 2, 3}).nearly_quantised());
  EXPECT_FALSE(survey(ValueType::float32, {none, none}).nearly_quantised());
}

// Half centimetres are means of two: all lie equally far above the lower one, but for the rounding of both.
TEST(ValueMap, HalvesGoToTheLowerStep) {
  const ValueMap map{ValueMap::Kind::near_steps, ValueType::float32, 130000, 1, 100};
  for (int n = 131000; n < 133000; ++n) {
    const double half = static_cast<float>((n + 0.5) / 100);
    EXPECT_EQ(map.number_of(half), n - 130000);
    EXPECT_NEAR(static_cast<double>(map.beside_of(half)), 0.005 / 0x1p-13, 1);  // floats of 1024 to 2048 are 2^-13 apart
  }
}

TEST(ValueMap, FloatsAboveStepsAreFiniteWhateverIsBeside) {
  for (const ValueType type : {ValueType::float32, ValueType::float64})
    for (const double numerator : {1.0, 1e300}) {
      const ValueMap map{ValueMap::Kind::near_steps, type, -17, numerator, 1e-5};
      for (std::uint64_t i = 0; i < 1000; ++i) {
        const double value = map.value_of(static_cast<std::int32_t>(hash_position(5, i)), hash_position(6, i) >> (i % 64));
        EXPECT_TRUE(std::isfinite(value));
        EXPECT_EQ(hold_to(type, value), value);
      }
    }
}

// Every n that the coder may turn a number into, after rounding to the type.
TEST(ValueMap, BoundsHoldAfterRounding) {
  for (double max_error : {0.0005, 0.01, 0.05, 0.1, 0.25, 3.0}) {
    for (int kind = 0; kind < 2; ++kind) {
      std::vector<double> values;
      for (std::uint64_t i = 0; i < 3000; ++i) {
        const double z = 1297 + 50 * uniform_at(2, i);
        values.push_back(kind ? static_cast<float>(std::round(z * 100) / 100) : static_cast<float>(z));
      }
      const std::optional<BoundedMap> bounded = map_within(ValueType::float32, values, max_error);
      ASSERT_TRUE(bounded) << max_error;
      EXPECT_EQ(bounded->step % 2, 1);
      for (double value : values) {
        const std::int32_t n = bounded->map.number_of(value);
        for (const std::int32_t m : {n - bounded->step / 2, n, n + bounded->step / 2}) ASSERT_LE(std::abs(bounded->map.value_of(m) - value), max_error) << value;
      }
    }
  }
  EXPECT_FALSE(map_within(ValueType::float32, std::vector<double>{1000.1F, 1300.7F}, 1e-6).has_value());
}

TEST(ValueMap, BoundsOfIntegersAreWholeSteps) {
  const std::vector<double> values{500, 3000};
  for (const auto& [bound, step] : std::vector<std::pair<double, int>>{{0.5, 1}, {1, 3}, {1.9, 3}, {20, 41}})
    EXPECT_EQ(map_within(ValueType::int16, values, bound)->step, step) << bound;
}

TEST(ValueMap, ComesBackFromBytes) {
  for (const ValueMap& map : {ValueMap{ValueMap::Kind::steps, ValueType::float32, -12345, 381, 1250}, ValueMap{ValueMap::Kind::float_bits, ValueType::float64, 1LL << 40},
                              ValueMap{ValueMap::Kind::double_bits, ValueType::float64, -(1LL << 30), 1, 1, 33},
                              ValueMap{ValueMap::Kind::near_steps, ValueType::float32, 130000, 1, 100},
                              // Found by tests/fuzz/round_trip_fuzz.cpp: doubles in a narrow range have a base of up to 64 bits.
                              ValueMap{ValueMap::Kind::double_bits, ValueType::float64, std::numeric_limits<std::int64_t>::max()},
                              ValueMap{ValueMap::Kind::double_bits, ValueType::float64, std::numeric_limits<std::int64_t>::min()}}) {
    ByteWriter out;
    put_value_map(map, out);
    ByteReader in(out.bytes(), "x");
    const ValueMap again = get_value_map(in, map.type);
    EXPECT_EQ(again.kind, map.kind);
    EXPECT_EQ(again.base, map.base);
    EXPECT_EQ(again.numerator, map.numerator);
    EXPECT_EQ(again.denominator, map.denominator);
    EXPECT_EQ(in.left(), 0U);
  }
  const std::vector<std::byte> lie{std::byte{3}, std::byte{0}};
  ByteReader in(lie, "x");
  EXPECT_THROW(get_value_map(in, ValueType::int16), Error);
  ByteWriter floats;
  put_value_map({ValueMap::Kind::near_steps, ValueType::float32, 5, 1, 100}, floats);
  ByteReader of_integers(floats.bytes(), "x");
  EXPECT_THROW(get_value_map(of_integers, ValueType::int16), Error);
}

}  // namespace
}  // namespace arete
