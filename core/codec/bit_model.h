#pragma once

#include <array>
#include <cstdint>

#include "core/codec/range_coder.h"

namespace arete {

// Adaptive probabilities of bits and their logistic mixing (Mahoney, "Adaptive weighing of context models for lossless data
// compression", 2005). Integers only; laid out to the last shift in core/codec/tree-format.md.

/// ln(p / (1 - p)) in 1/256, for p in 1/65536; within [-stretch_limit, stretch_limit].
inline constexpr int stretch_limit = 2816;
int stretch(Probability p);

/// The inverse: a probability of [16, 65520] for a logit in 1/256, held to [-stretch_limit, stretch_limit].
Probability squash(std::int64_t logit);

/// The probability of a 1 in one context, learned from the bits seen there. The first bits count most: after n bits the
/// step is 1/(n + 1.5), down to 1/(limit + 1.5).
struct BitModel {
  std::uint32_t state = 1U << 31;  ///< probability in 1/2^22, above the count of bits seen in 10 bits
  Probability p() const { return state >> 16; }
  void update(int bit, unsigned limit);
};

namespace detail {
/// 65536 / (n + 1.5), rounded down.
inline constexpr auto steps = [] {
  std::array<std::int32_t, 1024> table{};
  for (int n = 0; n < 1024; ++n) table[static_cast<std::size_t>(n)] = 131072 / (2 * n + 3);
  return table;
}();
extern const std::array<std::int16_t, 4096> stretch_table;
extern const std::array<std::uint16_t, 2 * stretch_limit + 1> squash_table;
}  // namespace detail

inline void BitModel::update(int bit, unsigned limit) {
  const unsigned n = state & 1023U;
  const std::int64_t way = std::int64_t{bit ? (1 << 22) - 1 : 0} - (state >> 10);
  // Both parts in one sum: the probability stays within its 22 bits, the count within its 10.
  state += (static_cast<std::uint32_t>((way * detail::steps[n]) >> 16) << 10) + (n < limit ? 1U : 0U);
}

inline int stretch(Probability p) { return detail::stretch_table[p >> 4]; }

inline Probability squash(std::int64_t logit) {
  auto place = static_cast<std::uint64_t>(logit + stretch_limit);
  if (place > 2U * stretch_limit) [[unlikely]] place = logit < 0 ? 0 : 2 * stretch_limit;
  return detail::squash_table[place];
}

/// Weighs the predictions of `count` contexts of the same bit; the weights follow the gradient of the code length.
template <int count>
struct BitMixer {
  std::array<std::int32_t, count> weights;  ///< 1/65536

  BitMixer() { weights.fill(65536 / count + 65536 / 8); }
  Probability mix(const std::array<int, count>& logits) const {
    std::int64_t sum = 0;
    for (int i = 0; i < count; ++i) sum += std::int64_t{weights[i]} * logits[i];
    return squash(sum >> 16);
  }
  void update(const std::array<int, count>& logits, Probability p, int bit, int rate) {
    const std::int64_t error = ((std::int64_t{bit} << 16) - std::int64_t{p}) * rate;
    for (int i = 0; i < count; ++i) weights[i] += static_cast<std::int32_t>((error * logits[i] + (1 << 19)) >> 20);
  }
};

}  // namespace arete
