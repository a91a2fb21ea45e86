#include "core/codec/wavelet_root.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/codec/bit_model.h"
#include "core/codec/range_coder.h"
#include "core/codec/wavelet.h"

namespace arete {
namespace {

// Differences have up to 38 bits.
constexpr float most_steps = 0x1p36F;

float root_step(const WaveletParameters& parameters) {
  return 2 * parameters.step / band_norm(std::max(1, parameters.grid.levels()), band_count);
}

}  // namespace

std::vector<std::byte> encode_wavelet_root(const Raster<float>& root, const WaveletParameters& parameters) {
  const float step = root_step(parameters);
  RangeEncoder encoder;
  BitModel exponent[40];
  std::int64_t before = 0;
  for (std::int64_t i = 0; i < root.size().cells(); ++i) {
    const auto value = static_cast<std::int64_t>(std::llround(hold_steps(root.data()[i] / step, most_steps)));
    const std::int64_t difference = value - before;
    const std::uint64_t folded = difference < 0 ? 2 * static_cast<std::uint64_t>(-difference) - 1 : 2 * static_cast<std::uint64_t>(difference);
    const int bits = std::bit_width(folded);
    for (int b = 0; b < 39; ++b) {
      encoder.encode(bits > b, std::clamp<Probability>(exponent[b].p(), 16, 65520));
      exponent[b].update(bits > b, 60);
      if (bits <= b) break;
    }
    for (int b = bits - 2; b >= 0; --b) encoder.encode(static_cast<int>((folded >> b) & 1), 1U << 15);
    before = value;
  }
  return encoder.finish();
}

Raster<float> decode_wavelet_root(std::span<const std::byte> bytes, const WaveletParameters& parameters) {
  const Size size = parameters.grid.level_size(parameters.grid.levels());
  const float step = root_step(parameters);
  RangeDecoder decoder(bytes);
  BitModel exponent[40];
  Raster<float> root(size.width, size.height);
  std::int64_t before = 0;
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    int bits = 0;
    while (bits < 39) {
      const int more = decoder.decode(std::clamp<Probability>(exponent[bits].p(), 16, 65520));
      exponent[bits].update(more, 60);
      if (!more) break;
      ++bits;
    }
    std::uint64_t folded = bits > 0 ? 1 : 0;
    for (int b = bits - 2; b >= 0; --b) folded = 2 * folded + static_cast<std::uint64_t>(decoder.decode(1U << 15));
    const auto half = static_cast<std::int64_t>((folded + 1) / 2);
    before += folded % 2 ? -half : half;
    root.data()[i] = static_cast<float>(before) * step;
  }
  return root;
}

}  // namespace arete
