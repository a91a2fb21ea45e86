#pragma once

#include <cstdint>

namespace arete {

/// 64 well-mixed bits from a seed and up to three coordinates (SplitMix64 finaliser, Steele, Lea & Flood, OOPSLA 2014).
/// Randomness in Arete is a function of position: no state, the same for any order of evaluation.
inline std::uint64_t hash_position(std::uint64_t seed, std::uint64_t x, std::uint64_t y = 0, std::uint64_t z = 0) {
  const auto mix = [](std::uint64_t v) {
    v += 0x9e3779b97f4a7c15ull;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
    return v ^ (v >> 31);
  };
  return mix(mix(mix(mix(seed) ^ x) ^ y) ^ z);
}

/// Uniform in [0, 1), 53 bits.
inline double uniform_at(std::uint64_t seed, std::uint64_t x, std::uint64_t y = 0, std::uint64_t z = 0) {
  return static_cast<double>(hash_position(seed, x, y, z) >> 11) * 0x1.0p-53;
}

}  // namespace arete
