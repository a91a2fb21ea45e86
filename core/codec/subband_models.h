#pragma once

#include <cstdint>

#include "core/codec/bit_model.h"
#include "core/codec/subband_coder.h"

namespace arete {

// The contexts of the coefficient coder. Counts are part of the format.

inline constexpr int energy_bins = 40;     ///< of the expected magnitude, four to an octave
inline constexpr int local_bins = 8;       ///< of a sum of magnitudes, about one to an octave
inline constexpr int unary_steps = 10;     ///< decisions "larger than u" before the Exp-Golomb code takes over
inline constexpr int mean_bins = 16;       ///< of the predicted coefficient over its expected magnitude
inline constexpr int sign_patterns = 27;   ///< signs of three neighbours
inline constexpr int exponent_steps = 28;  ///< of the Exp-Golomb code

struct SubbandModels {
  unsigned limit = 160;  ///< of the adaptation of probabilities, see BitModel; 1000 while they are trained
  // [decision][quantiser of the trellis state][...]
  BitModel energy[unary_steps][2][band_count][energy_bins];
  BitModel local[unary_steps][2][local_bins][local_bins][2];
  BitMixer<2> mixer[unary_steps][2][local_bins];
  BitModel exponent[4][exponent_steps];
  BitModel mantissa[exponent_steps];
  BitModel sign_mean[band_count][mean_bins];
  BitModel sign_pattern[band_count][sign_patterns];
  BitMixer<2> sign_mixer[band_count];
  BitModel block[band_count][local_bins][4];
};

}  // namespace arete
