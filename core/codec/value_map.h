#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/codec/byte_stream.h"
#include "core/terrain/value_type.h"

namespace arete {

/// How stored numbers become the integers that the predictive coder codes. Back: hold_to(type, (base + n) x numerator / denominator),
/// or, of kind float_bits, the Float32 whose bits, mapped so that larger floats have larger numbers, are base + n, or, of kind
/// double_bits, the Float64 whose bits, mapped so, are base + n followed by `low_bits` lower ones, which are no part of n, or, of kind
/// near_steps, the float so many floats of its type above what steps give as is kept beside n: 0 for most cells.
struct ValueMap {
  enum class Kind : std::uint8_t { steps = 1, float_bits = 2, double_bits = 3, near_steps = 4 };
  Kind kind = Kind::steps;
  ValueType type = ValueType::int16;
  std::int64_t base = 0;
  double numerator = 1;
  double denominator = 1;
  int low_bits = 0;  ///< 0 to greatest_low_bits; 0 of other kinds

  static constexpr int greatest_low_bits = 33;

  /// Whether numbers other than 0 may stand beside n: the lower bits, or the floats above the steps, modulo 2^64.
  bool has_beside() const { return low_bits > 0 || kind == Kind::near_steps; }
  /// The stored number of n and what stands beside it. Doubles in a fixed order: the same on every machine.
  double value_of(std::int32_t n, std::uint64_t beside = 0) const;
  /// The nearest n of a stored number within the range that the map was made for.
  std::int32_t number_of(double value) const;
  /// What stands beside the n of a stored number; 0 where it is NaN or the map has nothing beside.
  std::uint64_t beside_of(double value) const;
};

void put_value_map(const ValueMap& map, ByteWriter& out);
/// Safe for untrusted bytes: throws Error{damaged}.
ValueMap get_value_map(ByteReader& in, ValueType type);

/// Stored numbers of a raster; voids are NaN and are passed over.
using StoredValues = std::span<const double>;

struct StoredRange {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  void add(StoredValues values);
};

/// Which maps give all numbers of a raster back bit for bit; told its range first, then, part by part in any order, all its numbers.
class ValueSurvey {
 public:
  ValueSurvey(ValueType type, const StoredRange& range);
  void add(StoredValues values);
  /// Whole multiples of a common quantum (1, 1/2, 1/4, 1/10, ... 1/10000, feet in metres), the coarsest that fits. -0.0 is a
  /// number of its own, which no quantum gives back. Integers below 2^31 in range always have one.
  std::optional<ValueMap> quantised() const;
  /// The same, else the bits of 32-bit floats, or of 64-bit ones. Nullopt for integers that span more than 32 bits.
  std::optional<ValueMap> lossless() const;
  /// Of kind near_steps, the coarsest quantum that gives at least half of the numbers back (of one in 17, which it goes by). Nullopt
  /// where there is none, or it gives all back.
  std::optional<ValueMap> nearly_quantised() const;
  const StoredRange& range() const { return range_; }
  ValueType type() const { return type_; }

 private:
  struct Near {
    ValueMap map;
    std::int64_t exact = 0;  ///< numbers of the sample that it gives back
  };
  ValueType type_;
  StoredRange range_;
  std::vector<ValueMap> candidates_;  ///< that all numbers told so far agree with, the best first
  std::vector<Near> near_;            ///< of all quanta, for floats
  std::int64_t sampled_ = 0;
};

/// A map and the step of the coder (an odd number of n) with which no number is further off than `max_error` after hold_to.
struct BoundedMap {
  ValueMap map;
  std::int32_t step = 1;
};
/// `max_error` > 0, in stored units. Nullopt where the type is too coarse for the bound, or the range too wide for 32 bits.
std::optional<BoundedMap> map_within(const ValueSurvey& survey, double max_error);

}  // namespace arete
