#include "core/codec/value_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace arete {
namespace {

// n is held to 31 bits, so that sums of two fit 32.
constexpr double widest_range = 2147483000.0;

// Half of what the predictive coder can sum in 32 bits; a range below it decodes faster.
constexpr double narrow_range = 65000.0;

// Parts that a bound is divided into where the data have no quantum: finer parts make predictions finer.
constexpr std::int32_t finest_step = 31;
constexpr std::int32_t greatest_step = (1 << 24) - 1;

// What lies half way between two steps, as means of two such numbers do, goes to the lower one although it was rounded, so that all
// of these lie equally far above their steps.
constexpr double half_way = 1.0 / 64;

// Of how many numbers one is looked at for quanta that give most of them back: prime to the widths of most parts, so that no column of
// these is missed.
constexpr std::size_t sample_every = 17;

struct Quantum {
  double numerator, denominator;
};
// From the coarsest; 381/1250 is the foot, 1200/3937 the US survey foot.
constexpr std::array<Quantum, 14> quanta{{{1, 1}, {381, 1250}, {1200, 3937}, {1, 2}, {1, 4}, {1, 8}, {1, 10}, {1, 16}, {1, 32}, {1, 64}, {1, 100}, {1, 128}, {1, 1000}, {1, 10000}}};

// Larger floats have larger numbers; the two zeros are neighbours.
std::int64_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::int32_t>(value);
  return bits >= 0 ? std::int64_t{bits} : -std::int64_t{bits & 0x7fffffff} - 1;
}

float float_of(std::int64_t ordered) {
  ordered = std::clamp<std::int64_t>(ordered, -0x80000000LL, 0x7fffffffLL);
  return std::bit_cast<float>(ordered >= 0 ? static_cast<std::uint32_t>(ordered) : static_cast<std::uint32_t>(-ordered - 1) | 0x80000000U);
}

// The same of doubles.
std::int64_t ordered_bits(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits >= 0 ? bits : -(bits & std::numeric_limits<std::int64_t>::max()) - 1;
}

double double_of(std::int64_t ordered) {
  constexpr std::uint64_t sign = std::uint64_t{1} << 63;
  return std::bit_cast<double>(ordered >= 0 ? static_cast<std::uint64_t>(ordered) : static_cast<std::uint64_t>(-(ordered + 1)) | sign);
}

// The float of the type that lies so many of them further up, modulo 2^64, held to the finite ones.
double float_above(ValueType type, double value, std::uint64_t count) {
  const auto moved = [count](auto from, auto of) {
    constexpr auto highest = std::numeric_limits<decltype(from)>::max();
    const auto to = static_cast<std::int64_t>(static_cast<std::uint64_t>(ordered_bits(from)) + count);
    return static_cast<double>(of(std::clamp(to, ordered_bits(-highest), ordered_bits(highest))));
  };
  return type == ValueType::float32 ? moved(static_cast<float>(value), float_of) : moved(value, double_of);
}

// How many floats of the type `value` lies above `from`, modulo 2^64.
std::uint64_t floats_between(ValueType type, double from, double value) {
  const auto place = [type](double at) { return static_cast<std::uint64_t>(type == ValueType::float32 ? ordered_bits(static_cast<float>(at)) : ordered_bits(at)); };
  return place(value) - place(from);
}

// The map by the bits of doubles: as few lower ones as the range allows.
ValueMap double_bits_map(double lowest, double highest) {
  ValueMap map{ValueMap::Kind::double_bits, ValueType::float64};
  const auto span = [&] { return (ordered_bits(highest) >> map.low_bits) - (ordered_bits(lowest) >> map.low_bits); };
  // Unsigned: from the lowest double to the highest it is nearly 2^64.
  const auto wide = static_cast<std::uint64_t>(ordered_bits(highest)) - static_cast<std::uint64_t>(ordered_bits(lowest));
  while ((wide >> map.low_bits) >= 0x7ffffff0U) ++map.low_bits;
  map.base = (ordered_bits(lowest) >> map.low_bits) + span() / 2;
  return map;
}

bool has_quantum(ValueMap::Kind kind) { return kind == ValueMap::Kind::steps || kind == ValueMap::Kind::near_steps; }

bool same_quantum(const ValueMap& a, const ValueMap& b) { return a.numerator == b.numerator && a.denominator == b.denominator; }

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

// The steps of a quantum from the middle of the range on, or nullopt where they do not fit n.
std::optional<ValueMap> steps_map(ValueType type, const StoredRange& range, Quantum quantum) {
  const double low = range.lowest * quantum.denominator / quantum.numerator, high = range.highest * quantum.denominator / quantum.numerator;
  if (!(high - low < widest_range) || !(std::abs(low) < 0x1p52) || !(std::abs(high) < 0x1p52)) return std::nullopt;
  return ValueMap{ValueMap::Kind::steps, type, std::llround((low + high) / 2), quantum.numerator, quantum.denominator};
}

bool gives_back(const ValueMap& map, StoredValues values) {
  return std::all_of(values.begin(), values.end(), [&](double value) {
    return std::isnan(value) || same_bits(map.value_of(map.number_of(value), map.beside_of(value)), value);
  });
}

// The largest rounding of a decoded number to the type.
double rounding_of(ValueType type, const StoredRange& range) {
  const double greatest = std::max(std::abs(range.lowest), std::abs(range.highest));
  return type == ValueType::float32 ? std::ldexp(greatest, -24) : std::ldexp(greatest, -52);
}

}  // namespace

double ValueMap::value_of(std::int32_t n, std::uint64_t beside) const {
  if (kind == Kind::float_bits) return static_cast<double>(float_of(base + n));
  if (kind == Kind::double_bits) {
    // Unsigned: a damaged base wraps.
    const std::uint64_t high = static_cast<std::uint64_t>(base) + static_cast<std::uint64_t>(std::int64_t{n});
    return double_of(static_cast<std::int64_t>(high << low_bits | beside));
  }
  const double step = hold_to(type, static_cast<double>(base + n) * numerator / denominator);
  return kind == Kind::near_steps ? float_above(type, step, beside) : step;
}

std::int32_t ValueMap::number_of(double value) const {
  if (kind == Kind::double_bits) return static_cast<std::int32_t>((ordered_bits(value) >> low_bits) - base);
  const double number = kind == Kind::float_bits ? static_cast<double>(ordered_bits(static_cast<float>(value)))
                                                 : std::round(value * denominator / numerator - (kind == Kind::near_steps ? half_way : 0));
  return static_cast<std::int32_t>(std::clamp(number - static_cast<double>(base), -0x1p31, 0x1p31 - 1));
}

std::uint64_t ValueMap::beside_of(double value) const {
  if (!has_beside() || std::isnan(value)) return 0;
  if (kind == Kind::near_steps) return floats_between(type, value_of(number_of(value)), value);
  return static_cast<std::uint64_t>(ordered_bits(value)) & ((std::uint64_t{1} << low_bits) - 1);
}

void put_value_map(const ValueMap& map, ByteWriter& out) {
  out.put_u8(static_cast<std::uint8_t>(map.kind));
  out.put_varint(map.base < 0 ? 2 * static_cast<std::uint64_t>(-(map.base + 1)) + 1 : 2 * static_cast<std::uint64_t>(map.base));
  if (map.kind == ValueMap::Kind::double_bits) out.put_u8(static_cast<std::uint8_t>(map.low_bits));
  if (!has_quantum(map.kind)) return;
  out.put(map.numerator);
  out.put(map.denominator);
}

ValueMap get_value_map(ByteReader& in, ValueType type) {
  ValueMap map;
  map.type = type;
  const std::uint8_t kind = in.get_u8();
  if (kind < 1 || kind > 4) in.fail("its values are mapped in a way that does not exist");
  map.kind = static_cast<ValueMap::Kind>(kind);
  const std::uint64_t greatest = map.kind == ValueMap::Kind::double_bits ? std::numeric_limits<std::uint64_t>::max() : std::uint64_t{1} << 54;
  const std::uint64_t folded = in.get_varint(greatest, "the base of its values");
  map.base = folded % 2 ? -static_cast<std::int64_t>(folded / 2) - 1 : static_cast<std::int64_t>(folded / 2);
  if (map.kind == ValueMap::Kind::double_bits) map.low_bits = static_cast<int>(in.get_varint(ValueMap::greatest_low_bits, "the count of its lower bits"));
  if (map.kind == ValueMap::Kind::near_steps && is_integer(type)) in.fail("its values are whole numbers that are stored as floats");
  if (!has_quantum(map.kind)) return map;
  map.numerator = in.get<double>();
  map.denominator = in.get<double>();
  if (!(map.numerator > 0) || !std::isfinite(map.numerator) || !(map.denominator > 0) || !std::isfinite(map.denominator))
    in.fail("the quantum of its values is not a positive number");
  return map;
}

void StoredRange::add(StoredValues values) {
  for (double value : values) {
    if (std::isnan(value)) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
}

ValueSurvey::ValueSurvey(ValueType type, const StoredRange& range) : type_(type), range_(range) {
  if (range_.lowest > range_.highest) range_ = {0, 0};
  for (const Quantum& quantum : quanta) {
    if (const std::optional<ValueMap> map = steps_map(type, range_, quantum)) candidates_.push_back(*map);
    if (is_integer(type)) return;
  }
  for (const ValueMap& map : candidates_) near_.push_back({map});
  const std::int64_t low = ordered_bits(static_cast<float>(range_.lowest)), high = ordered_bits(static_cast<float>(range_.highest));
  candidates_.push_back({ValueMap::Kind::float_bits, type, (low + high) / 2});
  if (type == ValueType::float64) candidates_.push_back(double_bits_map(range_.lowest, range_.highest));
}

void ValueSurvey::add(StoredValues values) {
  std::erase_if(candidates_, [&](const ValueMap& map) { return !gives_back(map, values); });
  if (near_.empty()) return;
  for (std::size_t i = 0; i < values.size(); i += sample_every) {
    if (std::isnan(values[i])) continue;
    ++sampled_;
    for (Near& near : near_) near.exact += gives_back(near.map, values.subspan(i, 1));
  }
}

std::optional<ValueMap> ValueSurvey::lossless() const { return candidates_.empty() ? std::nullopt : std::optional(candidates_.front()); }

std::optional<ValueMap> ValueSurvey::quantised() const {
  const std::optional<ValueMap> best = lossless();
  return best && best->kind == ValueMap::Kind::steps ? best : std::nullopt;
}

std::optional<ValueMap> ValueSurvey::nearly_quantised() const {
  const auto most = std::find_if(near_.begin(), near_.end(), [this](const Near& near) { return sampled_ > 0 && 2 * near.exact >= sampled_; });
  if (most == near_.end()) return std::nullopt;
  const std::optional<ValueMap> all = quantised();
  if (all && same_quantum(*all, most->map)) return std::nullopt;
  ValueMap map = most->map;
  map.kind = ValueMap::Kind::near_steps;
  return map;
}

std::optional<BoundedMap> map_within(const ValueSurvey& survey, double max_error) {
  const ValueType type = survey.type();
  const StoredRange& range = survey.range();
  if (is_integer(type)) {
    const std::optional<ValueMap> map = steps_map(type, range, {1, 1});
    if (!map) return std::nullopt;
    return BoundedMap{*map, static_cast<std::int32_t>(std::min<double>(2 * std::floor(max_error) + 1, greatest_step))};
  }
  // The bound is left its rounding, and a little more for the products of number_of.
  const double usable = (max_error - rounding_of(type, range)) * (1 - 1e-9);
  if (!(usable > 0)) return std::nullopt;
  BoundedMap free;
  for (free.step = finest_step; free.step > 1 && (range.highest - range.lowest) * free.step / (2 * usable) > narrow_range; free.step -= 2) {
  }
  const std::optional<ValueMap> map = steps_map(type, range, {2 * usable / free.step, 1});
  if (!map) return std::nullopt;
  free.map = *map;
  // Data with a quantum: as many whole ones as the bound holds may be a wider step than twice the bound.
  if (const std::optional<ValueMap> whole = survey.quantised()) {
    const double quantum = whole->numerator / whole->denominator;
    const double within = std::floor((max_error - 2 * rounding_of(type, range)) / quantum * (1 + 1e-12));
    if ((2 * within + 1) * quantum >= 2 * usable && within < greatest_step / 2) return BoundedMap{*whole, static_cast<std::int32_t>(2 * within + 1)};
  }
  return free;
}

}  // namespace arete
