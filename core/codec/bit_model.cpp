#include "core/codec/bit_model.h"

// The logistic function by integers, so that its tables are the same on every machine: 1 / (1 + e^-t) at multiples of 1/256
// from e^(1/256) by repeated multiplication in 64-bit fixed point, rounded down each time.

namespace arete::detail {
namespace {

constexpr std::uint64_t one = std::uint64_t{1} << 32;

// floor(2^32 (e^(1/256) - 1)); Taylor's series gives 0.00391388933834757... and 2^32 times that is 16809946.7.
constexpr std::uint64_t growth = 16809946;

constexpr std::array<std::uint16_t, 2 * stretch_limit + 1> make_squash() {
  std::array<std::uint16_t, 2 * stretch_limit + 1> table{};
  std::uint64_t power = one;  // e^(k/256) in 1/2^32; below 2^48 for k <= stretch_limit
  for (unsigned k = 0; k <= stretch_limit; ++k) {
    // 65536 / (1 + e^-t) = 65536 e^t / (1 + e^t), the numerator scaled down to stay within 64 bits
    const std::uint64_t fine = power >> 8;
    const std::uint64_t p = (fine << 16) / (fine + (one >> 8));
    const std::uint64_t held = p > 65520 ? 65520 : p;
    table[stretch_limit + k] = static_cast<std::uint16_t>(held);
    table[stretch_limit - k] = static_cast<std::uint16_t>(65536 - held);
    // power (1 + growth / 2^32) without leaving 64 bits
    power += (power >> 32) * growth + (((power & 0xffffffff) * growth) >> 32);
  }
  return table;
}

constexpr auto squash_values = make_squash();

constexpr std::array<std::int16_t, 4096> make_stretch() {
  std::array<std::int16_t, 4096> table{};
  unsigned k = 0;
  for (unsigned i = 0; i < table.size(); ++i) {
    const unsigned p = i * 16 + 8;
    while (k + 1 < squash_values.size() && squash_values[k] < p) ++k;
    table[i] = static_cast<std::int16_t>(static_cast<int>(k) - stretch_limit);
  }
  return table;
}

}  // namespace

const std::array<std::uint16_t, 2 * stretch_limit + 1> squash_table = squash_values;
const std::array<std::int16_t, 4096> stretch_table = make_stretch();

}  // namespace arete::detail
