#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/codec/bit_model.h"
#include "core/codec/range_coder.h"

namespace arete {

// Coding and decoding by one and the same code: a function object takes the bit to code, or ignores it, and gives the bit.

struct EncodingBits {
  RangeEncoder& coder;
  int operator()(int bit, Probability p) {
    coder.encode(bit, p);
    return bit;
  }
};

struct DecodingBits {
  RangeDecoder& coder;
  int operator()(int, Probability p) { return coder.decode(p); }
};

inline constexpr unsigned model_limit = 255;  ///< of the adaptation of probabilities, see BitModel
inline constexpr int model_mixing_rate = 20;  ///< see BitMixer

/// A bit in one context.
template <class Bits>
int code_modelled(Bits& bits, BitModel& model, int bit) {
  bit = bits(bit, std::clamp<Probability>(model.p(), 16, 65520));
  model.update(bit, model_limit);
  return bit;
}

/// A bit in `count` contexts at once.
template <int count, class Bits>
int code_mixed(Bits& bits, const std::array<BitModel*, count>& contexts, BitMixer<count>& mixer, int bit) {
  std::array<int, count> logits;
  for (int i = 0; i < count; ++i) logits[i] = stretch(contexts[i]->p());
  const Probability p = mixer.mix(logits);
  bit = bits(bit, p);
  mixer.update(logits, p, bit, model_mixing_rate);
  for (int i = 0; i < count; ++i) contexts[i]->update(bit, model_limit);
  return bit;
}

/// Models of integers >= 0, each known by its place in `sets` sets of contexts: the number of its bits in unary, mixed over
/// the sets, then the bits behind the first, of which the first has a model.
template <int sets>
class NumberModels {
 public:
  static constexpr int most_bits = 27;

  explicit NumberModels(const std::array<int, sets>& contexts) {
    for (int s = 0; s < sets; ++s) unary_[s].resize(static_cast<std::size_t>(contexts[s]) * most_bits);
  }

  /// `value` (below 2^most_bits) is coded, or ignored where bits are decoded; gives the number.
  template <class Bits>
  std::uint32_t code(Bits& bits, const std::array<int, sets>& contexts, std::uint32_t value) {
    const int wanted = std::bit_width(value);
    int length = 0;
    while (length < most_bits && code_length_bit(bits, contexts, length, wanted > length)) ++length;
    std::uint32_t number = length > 0 ? 1 : 0;
    for (int i = length - 2; i >= 0; --i) {
      const int bit = static_cast<int>((value >> i) & 1U);
      number = 2 * number + static_cast<std::uint32_t>(i == length - 2 ? code_modelled(bits, second_[static_cast<std::size_t>(length)], bit)
                                                                       : bits(bit, 1U << 15));
    }
    return number;
  }

 private:
  template <class Bits>
  int code_length_bit(Bits& bits, const std::array<int, sets>& contexts, int length, int bit) {
    std::array<BitModel*, sets> models;
    for (int s = 0; s < sets; ++s) models[s] = &unary_[s][static_cast<std::size_t>(contexts[s] * most_bits + length)];
    return code_mixed<sets>(bits, models, mixers_[static_cast<std::size_t>(length)], bit);
  }

  std::array<std::vector<BitModel>, sets> unary_;
  std::array<BitMixer<sets>, most_bits> mixers_;
  std::array<BitModel, most_bits + 1> second_;
};

/// Signed integers as integers >= 0: 0, -1, 1, -2, 2 ... and back. |value| < 2^30.
inline std::uint32_t fold_sign(std::int32_t value) {
  return value < 0 ? 2 * static_cast<std::uint32_t>(-value) - 1 : 2 * static_cast<std::uint32_t>(value);
}
inline std::int32_t unfold_sign(std::uint32_t number) {
  const auto half = static_cast<std::int32_t>((number + 1) / 2);
  return number % 2 ? -half : half;
}

/// A bin for a size, two to an octave: 0, 1, 2, 3 for 0 to 3, then 4 for 4 and 5, 5 for 6 and 7, 6 for 8 to 11 ...
inline int half_octave(std::uint64_t size) {
  if (size < 2) return static_cast<int>(size);
  const int octave = std::bit_width(size) - 1;
  return 2 * octave + static_cast<int>((size >> (octave - 1)) & 1U);
}

}  // namespace arete
