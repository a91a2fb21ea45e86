#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/codec/node_grid.h"

namespace arete {

// What the decoder of the predictive coder must know beside the streams of the nodes. Laid out to the bit in
// core/codec/predictive-format.md.

/// The cells of level l - 1 by the parity of (x, y). The even-even ones are level l; the others are coded in this order.
enum class Phase : int { lattice = 0, centre = 1, on_row = 2, on_column = 3 };
inline constexpr int coded_phases = 3;

inline constexpr int filter_pairs = 14;    ///< the most point-symmetric pairs of taps that a phase has
inline constexpr int recursion_taps = 4;   ///< residuals of the same phase: west, north, north-west, north-east
inline constexpr int activity_weights = 9; ///< of what tells how large a residual is likely to be

inline constexpr std::int32_t tap_grain = 4;        ///< differences of taps between levels are multiples of it
inline constexpr std::int32_t recursion_grain = 4;  ///< so are recursion weights

/// How a phase of a level is predicted.
struct PhaseParameters {
  std::array<std::int32_t, filter_pairs> taps{};       ///< 1/4096; a pair's sum is weighed. They sum to 2048, their magnitudes to 8191 at most.
  std::array<std::int32_t, recursion_taps> recursion{};  ///< 1/256; sum of magnitudes <= 256
  std::array<std::uint8_t, activity_weights> activity{};  ///< 1/256
  int noise = 32;  ///< quarter octaves of the part of the expected magnitude that is always there, see noise_floor; 0 to 119
};

/// 1/256 of a unit.
inline std::uint32_t noise_floor(int noise) { return ((4U + (static_cast<unsigned>(noise) & 3U)) << (noise >> 2)) >> 2; }

struct LevelParameters {
  std::int32_t step = 1;  ///< residuals are multiples of it: 1 to 2^24
  std::array<PhaseParameters, coded_phases> phases;
};

struct PredictParameters {
  std::int32_t lowest = 0;   ///< decoded values are held to [lowest, highest]
  std::int32_t highest = 0;
  std::int32_t root_step = 1;
  std::vector<LevelParameters> levels;  ///< [l - 1] refines level l
  /// Sums fit 32 bits.
  bool narrow() const { return lowest >= -65536 && highest <= 65536; }
};

/// Taps and weights that suit most terrain; `step` and `noise` are 1 and 32.
const LevelParameters& default_level_parameters();

std::vector<std::byte> encode_parameters(const PredictParameters& parameters);

/// The inverse, for `levels` levels. Safe for untrusted bytes. Throws Error{damaged} where they say something that is not allowed.
PredictParameters decode_parameters(std::span<const std::byte> bytes, int levels, const std::string& name);

}  // namespace arete
