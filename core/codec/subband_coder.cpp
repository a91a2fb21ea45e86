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

Probability held(Probability p) { return std::clamp<Probability>(p, 16, 65520); }

template <class Bits>
int code_bit(Bits& bits, BitModel& model, unsigned limit, int bit) {
  bit = bits(bit, held(model.p()));
  model.update(bit, limit);
  return bit;
}

template <int count, class Bits>
int code_mixed(Bits& bits, const std::array<BitModel*, count>& contexts, BitMixer<count>& mixer, unsigned limit, int bit) {
  std::array<int, count> logits;
  for (int i = 0; i < count; ++i) logits[i] = stretch(contexts[i]->p());
  const Probability p = mixer.mix(logits);
  bit = bits(bit, p);
  mixer.update(logits, p, bit, mixing_rate);
  for (int i = 0; i < count; ++i) contexts[i]->update(bit, limit);
  return bit;
}

// Codes one coefficient in the contexts of its place.
template <class Bits>
class CoefficientCoder {
 public:
  CoefficientCoder(Bits bits, SubbandModels& models, int band) : bits_(bits), models_(models), band_(band) {}

  /// `value` is the coefficient (encoding) or ignored (decoding); gives the coefficient and moves the state.
  std::int32_t code(std::int32_t value, const CoefficientBlock& block, int x, int y, const RowContext& context, int& state) {
    const int quantiser = quantiser_of(state);
    place(block.magnitudes(y), x, context, quantiser);
    const std::int32_t k = code_index(lattice_index(std::abs(value), quantiser));
    state = trellis_next[static_cast<std::size_t>(state)][k & 1];
    if (k == 0) return 0;
    const bool negative = code_sign(value < 0, block.row(y) + x, block.stride());
    return negative ? -lattice_point(k, quantiser) : lattice_point(k, quantiser);
  }

 private:
  void place(const std::uint8_t* row, int x, const RowContext& context, int quantiser) {
    const auto i = static_cast<std::size_t>(x);
    const int left = row[x - 1];
    quantiser_ = quantiser;
    energy_ = expected_magnitude(context, band_, row, x);
    energy_bin_ = energy_bin(energy_);
    local_ = local_bin((context.near[i] + 2 * left) / 2);
    cross_ = context.cross[i];
    mixer_ = std::min(local_bins - 1, energy_bin_ / 4);
  }

  int code_decision(int u, int bit) {
    const std::array<BitModel*, 2> contexts{
        &models_.energy[u][quantiser_][band_][energy_bin_],
        &models_.local[u][quantiser_][local_][cross_][band_ == 2],
    };
    return code_mixed<2>(bits_, contexts, models_.mixer[u][quantiser_][mixer_], models_.limit, bit);
  }

  std::int32_t code_index(std::int32_t k) {
    for (int u = 0; u < unary_steps; ++u)
      if (!code_decision(u, k > u)) return u;
    return unary_steps + code_exp_golomb(k - unary_steps);
  }

  // Exp-Golomb: the number of bits of rest + 1 in unary, then these bits but the first.
  std::int32_t code_exp_golomb(std::int32_t rest) {
    BitModel* const exponents = models_.exponent[std::min(3, energy_bin_ / 10)];
    const int wanted = std::bit_width(static_cast<std::uint32_t>(rest) + 1) - 1;
    int bits = 0;
    while (bits < exponent_steps - 3 && code_bit(bits_, exponents[bits], models_.limit, wanted > bits)) ++bits;
    std::uint32_t value = 1;
    for (int i = bits - 1; i >= 0; --i) {
      const int bit = static_cast<int>(((static_cast<std::uint32_t>(rest) + 1) >> i) & 1U);
      value = 2 * value + static_cast<std::uint32_t>(i == bits - 1 ? code_bit(bits_, models_.mantissa[bits], models_.limit, bit) : bits_(bit, 1U << 15));
    }
    return static_cast<std::int32_t>(value) - 1;
  }

  bool code_sign(bool negative, const std::int32_t* at, std::ptrdiff_t stride) {
    const MeanWeights& w = mean_weights[band_];
    const auto held_value = [](std::int32_t v) { return std::clamp(v, -255, 255); };
    const int mean = w.left * held_value(at[-1]) + w.left2 * held_value(at[-2]) + w.up * held_value(at[-stride]) +
                     w.up2 * held_value(at[-2 * stride]) + w.up_left * held_value(at[-stride - 1]) +
                     w.up_right * held_value(at[-stride + 1]);
    const int bin = std::clamp(((mean >> 1) + 8 * (energy_ + 8)) / (energy_ + 8), 0, mean_bins - 1);
    const int pattern = (sign_of(at[-1]) + 1) + 3 * (sign_of(at[-stride]) + 1) + 9 * (sign_of(at[-stride - 1]) + 1);
    const std::array<BitModel*, 2> contexts{&models_.sign_mean[band_][bin], &models_.sign_pattern[band_][pattern]};
    return code_mixed<2>(bits_, contexts, models_.sign_mixer[band_], models_.limit, negative) != 0;
  }

  Bits bits_;
  SubbandModels& models_;
  int band_;
  int quantiser_ = 0, energy_ = 0, energy_bin_ = 0, local_ = 0, cross_ = 0, mixer_ = 0;
};

// Magnitudes of the parent under a square of a block.
int parent_magnitude(const CoefficientBlock& block, int x0, int y0) {
  int sum = 0;
  for (int y = y0; y < std::min(y0 + CoefficientBlock::square / 2, block.height()); ++y)
    for (int x = x0; x < std::min(x0 + CoefficientBlock::square / 2, block.width()); ++x) sum += block.magnitudes(y)[x];
  return sum;
}

// One flag for each square of a strip of squares: whether its coefficients are coded.
template <class Bits>
void code_flags(Bits& bits, SubbandModels& models, int band, const CoefficientBlock& wanted, const ParentView& parent, int strip,
                CoefficientBlock& block) {
  const int wide = block.squares_wide();
  std::uint8_t* flags = block.flags(strip);
  const std::uint8_t* above = strip > 0 ? block.flags(strip - 1) : nullptr;
  const int half = CoefficientBlock::square / 2;
  for (int b = 0; b < wide; ++b) {
    int neighbours = b > 0 ? flags[b - 1] : 0;
    if (above) neighbours += above[b] + (b + 1 < wide ? above[b + 1] : 0);
    const int coarse = parent.node ? parent_magnitude(parent.node->bands[static_cast<std::size_t>(band)],
                                                      parent.origin_x + b * half, parent.origin_y + strip * half)
                                   : 0;
    flags[b] = static_cast<std::uint8_t>(code_bit(bits, models.block[band][local_bin(coarse)][neighbours], models.limit, wanted.flags(strip)[b]));
  }
}

template <class Bits>
void code_band(Bits bits, SubbandModels& models, int band, const NodeCoefficients& target, const ParentView& parent, NodeCoefficients& done) {
  CoefficientBlock& block = done.bands[static_cast<std::size_t>(band)];
  const CoefficientBlock& wanted = target.bands[static_cast<std::size_t>(band)];
  if (block.width() == 0 || block.height() == 0) return;
  CoefficientCoder<Bits> coder(bits, models, band);
  RowContext context(block.width());
  int state = 0;
  for (int y = 0; y < block.height(); ++y) {
    const int strip = y / CoefficientBlock::square;
    if (y % CoefficientBlock::square == 0) code_flags(bits, models, band, wanted, parent, strip, block);
    const std::uint8_t* flags = block.flags(strip);
    if (std::none_of(flags, flags + block.squares_wide(), [](std::uint8_t f) { return f != 0; })) continue;
    prepare_row(done, parent, band, y, context);
    for (int b = 0; b < block.squares_wide(); ++b) {
      if (!flags[b]) continue;
      const int end = std::min((b + 1) * CoefficientBlock::square, block.width());
      for (int x = b * CoefficientBlock::square; x < end; ++x) block.set(x, y, coder.code(wanted.row(y)[x], block, x, y, context, state));
    }
  }
}

template <class Bits>
void code_node(Bits bits, SubbandModels& models, const NodeCoefficients& target, const ParentView& parent, NodeCoefficients& done) {
  for (int band = 0; band < band_count; ++band) code_band(bits, models, band, target, parent, done);
}

}  // namespace

std::vector<std::byte> encode_subbands(const NodeCoefficients& node, const ParentView& parent, SubbandModels& models) {
  NodeCoefficients done;
  for (std::size_t i = 0; i < band_count; ++i) done.bands[i] = CoefficientBlock(node.bands[i].width(), node.bands[i].height());
  RangeEncoder encoder;
  code_node(EncodingBits{encoder}, models, node, parent, done);
  return encoder.finish();
}

void decode_subbands(std::span<const std::byte> bytes, const ParentView& parent, SubbandModels& models, NodeCoefficients& node) {
  RangeDecoder decoder(bytes);
  // The coder reads its target only to encode: decoding, target and result are one.
  code_node(DecodingBits{decoder}, models, node, parent, node);
}

}  // namespace arete
