#include "core/codec/subband_coder.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "core/codec/subband_context.h"
#include "core/codec/subband_models.h"
#include "core/codec/trellis.h"

namespace arete {
namespace {

constexpr int mixing_rate = 20;

// The interval of the decoder is a copy that the compiler keeps in registers: everything between two bits is inlined for it.

struct EncodingBits {
  static constexpr bool decoding = false;
  RangeEncoder* coder;
  [[gnu::always_inline]] bool operator()(bool bit, Probability p) {
    coder->encode(bit, p);
    return bit;
  }
};

struct DecodingBits {
  static constexpr bool decoding = true;
  RangeDecoder* coder;
  RangeDecoder::Interval interval;
  [[gnu::always_inline]] bool operator()(bool, Probability p) { return coder->decode(p, interval) != 0; }
};

Probability held(Probability p) { return std::clamp<Probability>(p, 16, 65520); }

template <class Bits>
[[gnu::always_inline]] inline bool code_bit(Bits& bits, BitModel& model, unsigned limit, bool bit) {
  bit = bits(bit, held(model.p()));
  model.update(bit, limit);
  return bit;
}

// A bit that two contexts predict together. Each of its values has its own code, so that what follows need not wait for it.
template <class Bits>
[[gnu::always_inline]] inline bool code_mixed(Bits& bits, BitModel& a, BitModel& b, BitMixer<2>& mixer, unsigned limit, bool bit) {
  const std::array<int, 2> logits{stretch(a.p()), stretch(b.p())};
  const Probability p = mixer.mix(logits);
  const auto learn = [&](int value) __attribute__((always_inline)) {
    mixer.update(logits, p, value, mixing_rate);
    a.update(value, limit);
    b.update(value, limit);
  };
  if (bits(bit, p)) {
    learn(1);
    return true;
  }
  learn(0);
  return false;
}

/// local_bins times the bin of near + left.
constexpr auto near_offsets = [] {
  std::array<std::uint8_t, near_limit + 256> table{};
  for (int sum = 0; sum < near_limit + 256; ++sum) table[static_cast<std::size_t>(sum)] = static_cast<std::uint8_t>(local_bins * local_bin(sum));
  return table;
}();

constexpr auto mixer_bins = [] {
  std::array<std::uint8_t, energy_bins> table{};
  for (int bin = 0; bin < energy_bins; ++bin) table[static_cast<std::size_t>(bin)] = static_cast<std::uint8_t>(std::min(local_bins - 1, bin / 4));
  return table;
}();

// Codes the coefficients of a band in the contexts of their places.
template <class Bits, int band>
class CoefficientCoder {
 public:
  CoefficientCoder(Bits bits, SubbandModels& models) : bits_(bits), models_(models), limit_(models.limit) {}
  Bits& bits() { return bits_; }

  /// Columns of row y, whose context is prepared. Encoding, the block has them already.
  template <class Block>
  void code_columns(Block& block, int y, Columns columns, const RowContext& context) {
    Bits bits = bits_;
    SubbandModels& models = models_;
    const unsigned limit = limit_;
    unsigned state = state_;
    const auto row = block.row(y);
    const std::uint32_t* places = context.places.data();
    Before before{held(row[columns.first - 1]), held(row[columns.first - 2])};
    for (std::ptrdiff_t x = columns.first; x < columns.end; ++x) {
      const PlaceContext place = unpack_place(places[x]);
      const int left = std::abs(before.left);
      const unsigned energy = expected_magnitude(place, band, left, std::abs(before.left2));
      const int quantiser = quantiser_of(static_cast<int>(state));
      const std::int32_t k = code_index(bits, models, limit, place, energy, quantiser, left, Bits::decoding ? 0 : std::abs(row[x]));
      state = trellis_next[state][k & 1];
      if (k == 0) {
        before = {0, before.left};
        continue;
      }
      const std::int32_t magnitude = lattice_point(k, quantiser);
      const int near = std::min(magnitude, 255);
      const bool negative = code_sign(bits, models, limit, row[x] < 0, static_cast<int>(energy), context.signs[static_cast<std::size_t>(x)], before);
      before = {negative ? -near : near, before.left};
      if constexpr (Bits::decoding) row[x] = negative ? -magnitude : magnitude;
    }
    bits_ = bits;
    state_ = state;
    if constexpr (Bits::decoding) block.hold_magnitudes(y, columns.first, columns.end);
  }

 private:
  // The two coefficients before, held to -255..255.
  struct Before {
    int left, left2;
  };
  static int held(std::int32_t value) { return std::clamp(value, -255, 255); }

  [[gnu::always_inline]] static std::int32_t code_index(Bits& bits, SubbandModels& all, unsigned limit, PlaceContext place, unsigned energy, int quantiser, int left, std::int32_t magnitude) {
    SubbandModels::Quantiser& models = all.quantisers[quantiser];
    const std::size_t bin = energy_bin_table[energy];
    BitModel* const by_energy = models.energy[band][bin];
    BitModel* const by_place = models.local[band == 2][near_offsets[static_cast<std::size_t>(place.near + left)] + place.cross];
    BitMixer<2>* const mixers = models.mixer[mixer_bins[bin]];
    const std::int32_t k = lattice_index(magnitude, quantiser);
    if (!code_mixed(bits, by_energy[0], by_place[0], mixers[0], limit, k > 0)) return 0;
    for (int u = 1; u < unary_steps; ++u)
      if (!code_mixed(bits, by_energy[u], by_place[u], mixers[u], limit, k > u)) return u;
    return unary_steps + code_exp_golomb(bits, all, limit, static_cast<int>(bin), k - unary_steps);
  }

  // Exp-Golomb: the number of bits of rest + 1 in unary, then these bits but the first.
  [[gnu::always_inline]] static std::int32_t code_exp_golomb(Bits& bits, SubbandModels& models, unsigned limit, int bin, std::int32_t rest) {
    BitModel* const exponents = models.exponent[std::min(3, bin / 10)];
    const int wanted = std::bit_width(static_cast<std::uint32_t>(rest) + 1) - 1;
    int count = 0;
    while (count < exponent_steps - 3 && code_bit(bits, exponents[count], limit, wanted > count)) ++count;
    std::uint32_t value = 1;
    for (int i = count - 1; i >= 0; --i) {
      const bool bit = ((static_cast<std::uint32_t>(rest) + 1) >> i) & 1U;
      value = 2 * value + (i == count - 1 ? code_bit(bits, models.mantissa[count], limit, bit) : bits(bit, 1U << 15));
    }
    return static_cast<std::int32_t>(value) - 1;
  }

  [[gnu::always_inline]] static bool code_sign(Bits& bits, SubbandModels& models, unsigned limit, bool negative, int energy, std::int32_t above, Before before) {
    constexpr MeanWeights w = mean_weights[band];
    const int mean = (above >> 8) + w.left * before.left + w.left2 * before.left2;
    const int bin = std::clamp(((mean >> 1) + 8 * (energy + 8)) / (energy + 8), 0, mean_bins - 1);
    const int pattern = (above & 255) + sign_of(before.left) + 1;
    return code_mixed(bits, models.sign_mean[band][bin], models.sign_pattern[band][pattern], models.sign_mixer[band], limit, negative);
  }

  Bits bits_;
  SubbandModels& models_;
  const unsigned limit_;
  unsigned state_ = 0;
};

// Magnitudes of the parent under a square of a block.
int parent_magnitude(const CoefficientBlock& block, int x0, int y0) {
  int sum = 0;
  for (int y = y0; y < std::min(y0 + CoefficientBlock::square / 2, block.height()); ++y)
    for (int x = x0; x < std::min(x0 + CoefficientBlock::square / 2, block.width()); ++x) sum += block.magnitudes(y)[x];
  return sum;
}

// One flag for each square of a strip of squares: whether its coefficients are coded. Encoding, the block has them already.
template <class Bits, class Block>
[[gnu::always_inline]] inline void code_flags(Bits& bits, SubbandModels& models, int band, const ParentView& parent, int strip, Block& block) {
  const int wide = block.squares_wide();
  const auto flags = block.flags(strip);
  const std::uint8_t* above = strip > 0 ? block.flags(strip - 1) : nullptr;
  const int half = CoefficientBlock::square / 2;
  for (int b = 0; b < wide; ++b) {
    int neighbours = b > 0 ? flags[b - 1] : 0;
    if (above) neighbours += above[b] + (b + 1 < wide ? above[b + 1] : 0);
    const int coarse = parent.node ? parent_magnitude(parent.node->bands[static_cast<std::size_t>(band)],
                                                      parent.origin_x + b * half, parent.origin_y + strip * half)
                                   : 0;
    const bool on = code_bit(bits, models.block[band][local_bin(coarse)][neighbours], models.limit, flags[b] != 0);
    if constexpr (Bits::decoding) flags[b] = on;
  }
}

// `Node` is const to encode.
template <int band, class Bits, class Node>
Bits code_band(Bits bits, SubbandModels& models, const ParentView& parent, Node& node) {
  auto& block = node.bands[static_cast<std::size_t>(band)];
  if (block.width() == 0 || block.height() == 0) return bits;
  CoefficientCoder<Bits, band> coder(bits, models);
  RowContext context(block.width());
  for (int y = 0; y < block.height(); ++y) {
    const int strip = y / CoefficientBlock::square;
    if (y % CoefficientBlock::square == 0) code_flags(coder.bits(), models, band, parent, strip, block);
    visit_runs(block, strip, [&](Columns columns) {
      prepare_row(node, parent, band, y, columns, context);
      coder.code_columns(block, y, columns, context);
    });
  }
  return coder.bits();
}

template <class Bits, class Node>
void code_node(Bits bits, SubbandModels& models, const ParentView& parent, Node& node) {
  bits = code_band<0>(bits, models, parent, node);
  bits = code_band<1>(bits, models, parent, node);
  code_band<2>(bits, models, parent, node);
}

}  // namespace

std::vector<std::byte> encode_subbands(const NodeCoefficients& node, const ParentView& parent, SubbandModels& models) {
  RangeEncoder encoder;
  code_node(EncodingBits{&encoder}, models, parent, node);
  return encoder.finish();
}

void decode_subbands(std::span<const std::byte> bytes, const ParentView& parent, SubbandModels& models, NodeCoefficients& node) {
  RangeDecoder decoder(bytes);
  code_node(DecodingBits{&decoder, decoder.interval()}, models, parent, node);
}

}  // namespace arete
