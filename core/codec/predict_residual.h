#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "core/codec/bit_model.h"
#include "core/codec/range_coder.h"

namespace arete {

// The entropy coder of residuals: zero or not, magnitude by binary decisions relative to the magnitude that is expected,
// sign. One template serves both directions, so that they cannot differ.

/// Four times the binary logarithm of v >= 1, rounded down to a multiple of 1/4 of the way to the next power of two.
inline int quarter_log2(std::uint64_t v) {
  const int exponent = 63 - std::countl_zero(v << 2);  // of 4 v
  return 4 * (exponent - 2) + static_cast<int>(((v << 2) >> (exponent - 2)) & 3U);
}

/// Adaptive probabilities of a node's residuals.
struct ResidualModels {
  static constexpr int scales = 32;      ///< expected magnitudes: 28 quarter octaves below the shift, 4 above
  static constexpr int decisions = 8;    ///< zero, > 1, > 2, ... > 7 and all beyond
  std::array<std::array<BitModel, scales>, decisions> by_scale;
  std::array<BitModel, scales / 2 * 9> by_neighbours;  ///< of zero: expected magnitude, western and northern residuals
  std::array<BitModel, 128> by_relief;                 ///< of zero: spread and curvature
  std::array<BitModel, 32> first_low;
  std::array<BitModel, 16> second_low;
};

/// The models as each stream starts with them.
const ResidualModels& initial_residual_models();

/// What a residual is coded under.
struct ResidualContext {
  int shift = 0;       ///< low bits of the magnitude that are left to the end
  int scale = 0;
  int neighbours = 0;
  int relief = 0;
};

inline constexpr unsigned residual_limit = 1000;  ///< of the counts of the models
inline constexpr int unary_end = 20;              ///< from here on, Exp-Golomb

/// The probabilities of a 1 that the range coder takes.
inline Probability bounded(Probability p) { return std::clamp<Probability>(p, 16, 65520); }

/// Direction of coding: `bit` codes or reads one bit under a probability, `raw` up to 32 bits.
struct BitWriter {
  RangeEncoder& coder;
  int bit(int value, Probability p) {
    coder.encode(value, p);
    return value;
  }
  std::uint32_t raw(std::uint32_t value, int count) {
    coder.encode_raw(value, count);
    return value;
  }
};
struct BitReader {
  RangeDecoder& coder;
  int bit(int, Probability p) { return coder.decode(p); }
  std::uint32_t raw(std::uint32_t, int count) { return coder.decode_raw(count); }
};

template <typename Bits>
int code_bit(Bits& bits, BitModel& model, int value) {
  value = bits.bit(value, bounded(model.p()));
  model.update(value, residual_limit);
  return value;
}

/// value >= 0 in Exp-Golomb code of order 0, equal probabilities; read values are below 2^32.
template <typename Bits>
std::uint64_t code_exp_golomb(Bits& bits, std::uint64_t value) {
  const int wanted = 63 - std::countl_zero(value + 1);
  int length = 0;
  while (length < 32 && bits.raw(length < wanted, 1) != 0) ++length;
  const std::uint64_t low = length == 0 ? 0 : bits.raw(static_cast<std::uint32_t>((value + 1) & ((std::uint64_t{1} << length) - 1)), length);
  return ((std::uint64_t{1} << length) | low) - 1;
}

/// Codes or reads a residual, a multiple of the step: |residual| < 2^32.
template <typename Bits>
std::int64_t code_residual(Bits& bits, ResidualModels& models, const ResidualContext& context, std::int64_t residual) {
  const auto magnitude = static_cast<std::uint64_t>(residual < 0 ? -residual : residual);
  const std::uint64_t wanted = magnitude >> context.shift;
  const auto scale = static_cast<std::size_t>(context.scale);
  BitModel& zero = models.by_scale[0][scale];
  std::uint64_t value = 0;
  if (context.shift > 0) {
    value = static_cast<std::uint64_t>(code_bit(bits, zero, wanted != 0));
  } else {
    // below a magnitude or two the surroundings say more than their weighted sum
    BitModel& neighbours = models.by_neighbours[static_cast<std::size_t>(context.neighbours)];
    BitModel& relief = models.by_relief[static_cast<std::size_t>(context.relief)];
    const Probability p = bounded((2 * zero.p() + neighbours.p() + relief.p()) >> 2);
    const int bit = bits.bit(wanted != 0, p);
    zero.update(bit, residual_limit);
    neighbours.update(bit, residual_limit);
    relief.update(bit, residual_limit);
    if (bit == 0) return 0;
    value = 1;
  }
  if (value != 0) {
    while (value < unary_end) {
      if (code_bit(bits, models.by_scale[std::min<std::size_t>(value, ResidualModels::decisions - 1)][scale], wanted > value) == 0) break;
      ++value;
    }
    if (value == unary_end) value += code_exp_golomb(bits, wanted >= unary_end ? wanted - unary_end : 0);
  }
  int left = context.shift;
  if (left > 0) {
    --left;
    const auto model = static_cast<std::size_t>(std::min<std::uint64_t>(value, 7) * 4) + (scale & 3U);
    value = 2 * value + static_cast<std::uint64_t>(code_bit(bits, models.first_low[model], static_cast<int>((magnitude >> left) & 1U)));
  }
  if (left > 0) {
    --left;
    const auto model = static_cast<std::size_t>(std::min<std::uint64_t>(value, 15));
    value = 2 * value + static_cast<std::uint64_t>(code_bit(bits, models.second_low[model], static_cast<int>((magnitude >> left) & 1U)));
  }
  if (left > 0) value = (value << left) | bits.raw(static_cast<std::uint32_t>(magnitude & ((std::uint64_t{1} << left) - 1)), left);
  if (value == 0) return 0;
  const bool negative = bits.raw(residual < 0, 1) != 0;
  const auto out = static_cast<std::int64_t>(value);
  return negative ? -out : out;
}

}  // namespace arete
