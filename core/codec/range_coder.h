#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace arete {

// A binary arithmetic coder: each bit costs its information under the probability given with it, to about 2^-16 bits.
// The interval [low, high] of 64-bit integers shrinks with each bit and moves out 32 bits at a time, so that neither carries
// nor multiplications beyond 64 bits are needed. Integers only: the same bytes everywhere. Cost: about 3 ns a bit.

/// Probabilities of a 1, as 16-bit fixed point: p / 65536, 0 < p < 65536.
using Probability = std::uint32_t;

namespace detail {
/// The upper halves agree, or the interval is too short to be divided well.
inline bool must_shift(std::uint64_t low, std::uint64_t high) {
  return ((low ^ high) >> 32) == 0 || high - low < (std::uint64_t{1} << 24);
}
}  // namespace detail

class RangeEncoder {
 public:
  void encode(int bit, Probability p);
  /// Bits of equal probability, the most significant first; 0 <= count <= 32.
  void encode_raw(std::uint32_t value, int count);
  /// Ends the stream and hands over its bytes. Zero bytes at the end are dropped: the decoder supplies them.
  std::vector<std::byte> finish();
  std::size_t size() const { return bytes_.size(); }

 private:
  void shift_out();
  std::uint64_t low_ = 0;
  std::uint64_t high_ = ~std::uint64_t{0};
  std::vector<std::byte> bytes_;
};

/// Reads back what an encoder wrote, given the same probabilities. Safe for untrusted input: past the end of `bytes` it
/// reads zeros, and whatever the bytes say, each call gives some bit.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes);
  int decode(Probability p) {
    const std::uint64_t middle = low_ + ((high_ - low_) >> 16) * p;
    const int bit = code_ <= middle;
    if (bit)
      high_ = middle;
    else
      low_ = middle + 1;
    if (detail::must_shift(low_, high_)) shift_in();
    return bit;
  }
  std::uint32_t decode_raw(int count);

 private:
  void shift_in();
  std::uint64_t low_ = 0;
  std::uint64_t high_ = ~std::uint64_t{0};
  std::uint64_t code_ = 0;
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace arete
