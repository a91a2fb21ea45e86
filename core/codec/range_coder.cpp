#include "core/codec/range_coder.h"

#include <utility>

// After "Arithmetic coding revisited" (Moffat, Neal, Witten, 1998) in the carry-less form of Subbotin (1999): when the interval
// straddles a 32-bit boundary and has become short, its upper part is given up.

namespace arete {
namespace {

constexpr std::uint64_t low_half = 0xffffffff;

// Gives up the part of a short interval beyond the boundary that it straddles: about 2 bits once in 2^8 shifts.
std::uint64_t cut_high(std::uint64_t low, std::uint64_t high) { return ((low ^ high) >> 32) == 0 ? high : (low | low_half); }

}  // namespace

void RangeEncoder::encode(int bit, Probability p) {
  const std::uint64_t middle = low_ + ((high_ - low_) >> 16) * p;
  if (bit)
    high_ = middle;
  else
    low_ = middle + 1;
  if (detail::must_shift(low_, high_)) shift_out();
}

void RangeEncoder::encode_raw(std::uint32_t value, int count) {
  for (int i = count - 1; i >= 0; --i) encode(static_cast<int>((value >> i) & 1U), 1U << 15);
}

void RangeEncoder::shift_out() {
  while (detail::must_shift(low_, high_)) {
    high_ = cut_high(low_, high_);
    for (int shift = 56; shift >= 32; shift -= 8) bytes_.push_back(static_cast<std::byte>(low_ >> shift));
    low_ <<= 32;
    high_ = (high_ << 32) | low_half;
  }
}

std::vector<std::byte> RangeEncoder::finish() {
  // The value of fewest bytes inside the interval; what follows it reads as zeros.
  for (int bits = 8; bits <= 64; bits += 8) {
    const std::uint64_t mask = bits == 64 ? 0 : (~std::uint64_t{0} >> bits);
    if (low_ > ~mask) continue;  // rounding up would leave 64 bits
    const std::uint64_t value = (low_ + mask) & ~mask;
    if (value > high_) continue;
    for (int shift = 56; shift >= 64 - bits; shift -= 8) bytes_.push_back(static_cast<std::byte>(value >> shift));
    break;
  }
  while (!bytes_.empty() && bytes_.back() == std::byte{0}) bytes_.pop_back();
  low_ = 0;
  high_ = ~std::uint64_t{0};
  return std::move(bytes_);
}

RangeDecoder::RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
  for (int i = 0; i < 8; ++i)
    code_ = (code_ << 8) | (position_ < bytes_.size() ? std::to_integer<std::uint64_t>(bytes_[position_]) : 0), ++position_;
}

void RangeDecoder::shift_in() {
  while (detail::must_shift(low_, high_)) {
    high_ = cut_high(low_, high_);
    low_ <<= 32;
    high_ = (high_ << 32) | low_half;
    for (int i = 0; i < 4; ++i) {
      code_ = (code_ << 8) | (position_ < bytes_.size() ? std::to_integer<std::uint64_t>(bytes_[position_]) : 0);
      ++position_;
    }
  }
}

std::uint32_t RangeDecoder::decode_raw(int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = (value << 1) | static_cast<std::uint32_t>(decode(1U << 15));
  return value;
}

}  // namespace arete
