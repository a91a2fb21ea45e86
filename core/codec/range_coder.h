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

// Intervals are kept as their first value and their width less one. As long as the width has more than 32 bits nothing can move
// out, which is all that the common case asks; the rest is decided in range_coder.cpp.

class RangeEncoder {
 public:
  void encode(int bit, Probability p) {
    const std::uint64_t part = (width_ >> 16) * p;
    if (bit) {
      width_ = part;
    } else {
      low_ += part + 1;
      width_ -= part + 1;
    }
    if (width_ >> 32 == 0) [[unlikely]] shift_out();
  }
  /// Bits of equal probability, the most significant first; 0 <= count <= 32.
  void encode_raw(std::uint32_t value, int count);
  /// Ends the stream and hands over its bytes. Zero bytes at the end are dropped: the decoder supplies them.
  std::vector<std::byte> finish();
  std::size_t size() const { return bytes_.size(); }

 private:
  void shift_out();
  std::uint64_t low_ = 0;
  std::uint64_t width_ = ~std::uint64_t{0};
  std::vector<std::byte> bytes_;
};

/// Reads back what an encoder wrote, given the same probabilities. Safe for untrusted input: past the end of `bytes` it
/// reads zeros, and whatever the bytes say, each call gives some bit.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes);
  /// The interval as seen from the code: its width less one and how far the code lies above its first value.
  struct Interval {
    std::uint64_t width;
    std::uint64_t offset;
  };
  int decode(Probability p) { return decode(p, interval_); }
  std::uint32_t decode_raw(int count);

  /// The same on an interval that the caller keeps, so that a long loop has it in registers: starts as interval(), and all bits
  /// from there on are decoded from it.
  int decode(Probability p, Interval& at) {
    const std::uint64_t part = (at.width >> 16) * p;
    const int bit = at.offset <= part;
    if (bit) {
      at.width = part;
    } else {
      at.offset -= part + 1;
      at.width -= part + 1;
    }
    if (at.width >> 32 == 0) [[unlikely]] at = shift_in(at);
    return bit;
  }
  const Interval& interval() const { return interval_; }

 private:
  Interval shift_in(Interval at);
  std::uint64_t next_bytes(int count);
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  std::uint64_t code_ = 0;
  std::uint64_t base_ = 0;  ///< the code, or the first value of the interval where that is greater
  Interval interval_;
};

}  // namespace arete
