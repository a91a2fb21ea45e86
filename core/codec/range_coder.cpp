#include "core/codec/range_coder.h"

#include <utility>

// After "Arithmetic coding revisited" (Moffat, Neal, Witten, 1998) in the carry-less form of Subbotin (1999): when the interval
// straddles a 32-bit boundary and has become short, its upper part is given up.

namespace arete {
namespace {

constexpr std::uint64_t low_half = 0xffffffff;

// The upper halves agree, or the interval is too short to be divided well.
bool must_shift(std::uint64_t low, std::uint64_t width) { return ((low ^ (low + width)) >> 32) == 0 || width < (std::uint64_t{1} << 24); }

// The width of what moves on. The part of a short interval beyond the boundary that it straddles is given up: about 2 bits once
// in 2^8 shifts.
std::uint64_t shifted_width(std::uint64_t low, std::uint64_t width) {
  const std::uint64_t high = low + width;
  const std::uint64_t kept = ((low ^ high) >> 32) == 0 ? high : (low | low_half);
  return ((kept << 32) | low_half) - (low << 32);
}

}  // namespace

void RangeEncoder::encode_raw(std::uint32_t value, int count) {
  for (int i = count - 1; i >= 0; --i) encode(static_cast<int>((value >> i) & 1U), 1U << 15);
}

void RangeEncoder::shift_out() {
  while (must_shift(low_, width_)) {
    for (int shift = 56; shift >= 32; shift -= 8) bytes_.push_back(static_cast<std::byte>(low_ >> shift));
    width_ = shifted_width(low_, width_);
    low_ <<= 32;
  }
}

std::vector<std::byte> RangeEncoder::finish() {
  // The value of fewest bytes inside the interval; what follows it reads as zeros.
  const std::uint64_t high = low_ + width_;
  for (int bits = 8; bits <= 64; bits += 8) {
    const std::uint64_t mask = bits == 64 ? 0 : (~std::uint64_t{0} >> bits);
    if (low_ > ~mask) continue;  // rounding up would leave 64 bits
    const std::uint64_t value = (low_ + mask) & ~mask;
    if (value > high) continue;
    for (int shift = 56; shift >= 64 - bits; shift -= 8) bytes_.push_back(static_cast<std::byte>(value >> shift));
    break;
  }
  while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
  low_ = 0;
  width_ = ~std::uint64_t{0};
  return std::move(bytes_);
}

RangeDecoder::RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes), code_(next_bytes(8)), base_(code_), interval_{~std::uint64_t{0}, code_} {}

std::uint64_t RangeDecoder::next_bytes(int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) {
    value = (value << 8) | (position_ < bytes_.size() ? std::to_integer<std::uint64_t>(bytes_[position_]) : 0);
    ++position_;
  }
  return value;
}

RangeDecoder::Interval RangeDecoder::shift_in(Interval at) {
  std::uint64_t low = base_ - at.offset;
  while (must_shift(low, at.width)) {
    at.width = shifted_width(low, at.width);
    low <<= 32;
    code_ = (code_ << 32) | next_bytes(4);
  }
  // Bytes that no encoder wrote may bring a code outside the interval. Below it all bits are 1, as they are at its first value.
  base_ = code_ > low ? code_ : low;
  at.offset = base_ - low;
  return at;
}

std::uint32_t RangeDecoder::decode_raw(int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = (value << 1) | static_cast<std::uint32_t>(decode(1U << 15));
  return value;
}

}  // namespace arete
