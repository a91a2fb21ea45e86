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
  /// Of one of the trellis state's quantisers. The decisions of a coefficient lie side by side.
  struct Quantiser {
    BitModel energy[band_count][energy_bins][unary_steps];
    BitModel local[2][local_bins * local_bins][unary_steps];  ///< [1 of the diagonal band][near bin x local_bins + cross bin]
    BitMixer<2> mixer[local_bins][unary_steps];
  };
  Quantiser quantisers[2];
  BitModel exponent[4][exponent_steps];
  BitModel mantissa[exponent_steps];
  BitModel sign_mean[band_count][mean_bins];
  BitModel sign_pattern[band_count][sign_patterns];
  BitMixer<2> sign_mixer[band_count];
  BitModel block[band_count][local_bins][4];
};

/// Visits all models and mixers in the order in which core/codec/tree-format.md lists their first states.
template <class Models, class Visit>
void visit_models(Models& models, Visit visit) {
  for (int u = 0; u < unary_steps; ++u)
    for (auto& quantiser : models.quantisers)
      for (auto& band : quantiser.energy)
        for (auto& bin : band) visit(bin[u]);
  for (int u = 0; u < unary_steps; ++u)
    for (auto& quantiser : models.quantisers)
      for (int bins = 0; bins < local_bins * local_bins; ++bins)
        for (auto& diagonal : quantiser.local) visit(diagonal[bins][u]);
  for (auto& step : models.exponent)
    for (auto& model : step) visit(model);
  for (auto& model : models.mantissa) visit(model);
  for (auto& band : models.sign_mean)
    for (auto& model : band) visit(model);
  for (auto& band : models.sign_pattern)
    for (auto& model : band) visit(model);
  for (auto& band : models.block)
    for (auto& bin : band)
      for (auto& model : bin) visit(model);
  for (int u = 0; u < unary_steps; ++u)
    for (auto& quantiser : models.quantisers)
      for (auto& bin : quantiser.mixer) visit(bin[u]);
  for (auto& mixer : models.sign_mixer) visit(mixer);
}

}  // namespace arete
