#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "core/codec/bit_model.h"
#include "core/codec/range_coder.h"

namespace arete {

// The entropy coder of residuals: magnitude by binary decisions under what the surroundings let expect, sign. Each decision is
// a logistic mix of four contexts. One template serves both directions, so that they cannot differ.

/// Four times the binary logarithm of v >= 1, rounded down to a multiple of 1/4 of the way to the next power of two.
inline int quarter_log2(std::uint64_t v) {
  const int exponent = 63 - std::countl_zero(v << 2);  // of 4 v
  return 4 * (exponent - 2) + static_cast<int>(((v << 2) >> (exponent - 2)) & 3U);
}

inline constexpr int residual_scales = 32;  ///< of expected magnitudes, in quarter octaves, below and above the step
inline constexpr int unshifted_scale = 25;   ///< the scale of an expected magnitude of one step

/// What a residual is coded under.
struct ResidualContext {
  int shift = 0;   ///< low bits of the magnitude that are left to the end
  int scale = 0;   ///< of the expected magnitude: 0 to residual_scales - 1
  int lean = 8;    ///< of the prediction before it was rounded, 0 to 15: below 8 the true value is likely to be lower
  int beside = 0;  ///< the western and the northern magnitude against the expected one: 0 to 15
  int relief = 0;  ///< spread and curvature: 0 to 255
  int wide = 0;    ///< magnitudes further around: 0 to 23
  int turn = 0;    ///< signs of the western and the northern residual: 0 to 8
  int phase = 0;   ///< of the three, 0 to 2
};

/// Adaptive probabilities of a node's residuals.
struct ResidualModels {
  static constexpr int decisions = 3;  ///< that are mixed: > 0, > 1, > 2
  static constexpr int others = 4;     ///< > 3, ... > 5, and all beyond: they are rare, and the scale says nearly all
  template <int size>
  using Decisions = std::array<std::array<BitModel, size>, decisions>;

  Decisions<9 * residual_scales> by_scale;       ///< |lean - 8|, scale
  Decisions<residual_scales / 2 * 16> by_beside;  ///< scale / 2, beside
  Decisions<256> by_relief;
  Decisions<24 * residual_scales / 2> by_wide;    ///< wide, scale / 2
  std::array<std::array<BitModel, residual_scales>, others> beyond;  ///< scale
  std::array<BitModel, 32> first_low;
  std::array<BitModel, 16> second_low;
  std::array<BitModel, 16 * 8> sign_by_lean;      ///< lean, scale / 4
  std::array<BitModel, 3 * 9> sign_by_turn;       ///< phase, turn
  std::array<std::array<BitMixer<4>, 3 * 8>, decisions> mixers;  ///< phase, scale / 4
  BitMixer<2> sign_mixer;
  unsigned limit = 400;  ///< of the counts of the models
};

/// Visits all that is learned, in the order of the table of first states.
template <class Visitor>
void for_each_state(ResidualModels& models, const Visitor& visit) {
  visit(models.by_scale);
  visit(models.by_beside);
  visit(models.by_relief);
  visit(models.by_wide);
  visit(models.beyond);
  visit(models.first_low);
  visit(models.second_low);
  visit(models.sign_by_lean);
  visit(models.sign_by_turn);
  visit(models.mixers);
  visit(models.sign_mixer);
}

/// The models as each stream starts with them: as they were after many nodes of real DEMs.
const ResidualModels& initial_residual_models();

inline constexpr int residual_mixing_rate = 6;  ///< see BitMixer
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

inline constexpr unsigned plain_limit = 1000;  ///< of the counts of models that are not mixed

template <typename Bits>
int code_bit(Bits& bits, BitModel& model, int value, unsigned limit = plain_limit) {
  value = bits.bit(value, bounded(model.p()));
  model.update(value, limit);
  return value;
}

template <int count, typename Bits>
int code_mixed_bit(Bits& bits, const std::array<BitModel*, count>& models, BitMixer<count>& mixer, int value, unsigned limit) {
  std::array<int, count> logits;
  for (std::size_t i = 0; i < count; ++i) logits[i] = stretch(models[i]->p());
  const Probability p = mixer.mix(logits);
  value = bits.bit(value, p);
  mixer.update(logits, p, value, residual_mixing_rate);
  for (BitModel* model : models) model->update(value, limit);
  return value;
}

/// Whether the magnitude, without its low bits, is above `decision`.
template <typename Bits>
int code_decision(Bits& bits, ResidualModels& models, const ResidualContext& c, std::uint64_t decision, int value) {
  const auto d = static_cast<std::size_t>(decision);
  if (d >= ResidualModels::decisions) {
    const std::size_t other = std::min<std::size_t>(d - ResidualModels::decisions, ResidualModels::others - 1);
    return code_bit(bits, models.beyond[other][static_cast<std::size_t>(c.scale)], value, models.limit);
  }
  const auto at = [](auto& row, int place) { return &row[static_cast<std::size_t>(place)]; };
  const int coarse = c.scale / 2;
  return code_mixed_bit<4>(bits,
                           {at(models.by_scale[d], std::abs(c.lean - 8) * residual_scales + c.scale), at(models.by_beside[d], coarse * 16 + c.beside),
                            at(models.by_relief[d], c.relief), at(models.by_wide[d], c.wide * residual_scales / 2 + coarse)},
                           models.mixers[d][static_cast<std::size_t>(c.phase * 8 + c.scale / 4)], value, models.limit);
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
  std::uint64_t value = 0;
  while (value < unary_end && code_decision(bits, models, context, value, wanted > value) != 0) ++value;
  if (value == unary_end) value += code_exp_golomb(bits, wanted >= unary_end ? wanted - unary_end : 0);
  int left = context.shift;
  const auto low_bit = [&] { return static_cast<int>((magnitude >> left) & 1U); };
  if (left > 0) {
    --left;
    const auto model = static_cast<std::size_t>(std::min<std::uint64_t>(value, 7) * 4) + (static_cast<std::size_t>(context.scale) & 3U);
    value = 2 * value + static_cast<std::uint64_t>(code_bit(bits, models.first_low[model], low_bit(), models.limit));
  }
  if (left > 0) {
    --left;
    const auto model = static_cast<std::size_t>(std::min<std::uint64_t>(value, 15));
    value = 2 * value + static_cast<std::uint64_t>(code_bit(bits, models.second_low[model], low_bit(), models.limit));
  }
  if (left > 0) value = (value << left) | bits.raw(static_cast<std::uint32_t>(magnitude & ((std::uint64_t{1} << left) - 1)), left);
  if (value == 0) return 0;
  const std::array<BitModel*, 2> signs{&models.sign_by_lean[static_cast<std::size_t>(context.lean * 8 + context.scale / 4)],
                                       &models.sign_by_turn[static_cast<std::size_t>(context.phase * 9 + context.turn)]};
  const auto out = static_cast<std::int64_t>(value);
  return code_mixed_bit<2>(bits, signs, models.sign_mixer, residual < 0, models.limit) != 0 ? -out : out;
}

}  // namespace arete
