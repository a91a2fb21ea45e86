#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/codec/subband_coder.h"
#include "core/codec/subband_models.h"

namespace arete {

// What the coefficient coder and the quantiser know of a coefficient from the ones around it.

// Expected magnitude from the magnitudes around, in 1/256: fitted by non-negative least squares, each error weighed by
// the expected magnitude, on the quantised bands of real DEMs (tests/bench/train_subband_states.cpp).
struct EnergyWeights {
  int left, left2, up, up2, up_left, up_right;  // the same band
  int first, first_around;                      // the node's horizontal band at the same place; sum of its four neighbours
  int second, second_around;                    // its vertical band
  int parent, parent_around;
};
inline constexpr EnergyWeights energy_weights[band_count] = {
    {56, 15, 48, 18, 18, 32, 0, 0, 0, 0, 6, 2},
    {51, 16, 47, 7, 15, 27, 12, 6, 0, 0, 6, 1},
    {36, 8, 33, 5, 16, 31, 10, 4, 10, 3, 3, 0},
};

// The coefficient predicted from signed neighbours, in 1/256; fitted in the same way.
struct MeanWeights {
  int left, left2, up, up2, up_left, up_right;
};
inline constexpr MeanWeights mean_weights[band_count] = {
    {-63, 3, 8, 7, -3, -7},
    {22, 4, -63, 3, -4, -12},
    {-11, -1, -8, 0, 8, 14},
};

inline int energy_bin(int sixteenths) {
  if (sixteenths < 2) return 0;
  const int octave = std::bit_width(static_cast<unsigned>(sixteenths)) - 1;
  const int fraction = octave >= 2 ? (sixteenths >> (octave - 2)) & 3 : (sixteenths << (2 - octave)) & 3;
  return std::clamp(4 * octave + fraction - 2, 0, energy_bins - 1);
}

inline int local_bin(int sum) {
  constexpr std::array<std::uint8_t, 26> table{0, 1, 2, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 7};
  return table[static_cast<std::size_t>(std::min(sum, 25))];
}

inline int sign_of(std::int32_t value) { return (value > 0) - (value < 0); }

/// What of a row's contexts is known before the row is coded.
struct RowContext {
  std::vector<std::uint16_t> energy;  ///< weighted magnitudes, 1/256
  std::vector<std::uint16_t> near;    ///< up twice, up-left and up-right
  std::vector<std::uint8_t> cross;    ///< bin of the other bands' and the parent's magnitudes
  explicit RowContext(int width);
  std::vector<std::uint16_t> others;        ///< sums that become `cross`
  std::vector<std::uint16_t> here, around;  ///< the parent's, of half as many columns
};

/// Fills the context of row y of a band from the rows above, the bands before and the parent.
void prepare_row(const NodeCoefficients& node, const ParentView& parent, int band, int y, RowContext& context);

/// The expected magnitude at x, in 1/16, with what is left of it in the row. The weights of a band sum to less than 257, so
/// that 16 bits hold the sum.
inline int expected_magnitude(const RowContext& context, int band, const std::uint8_t* magnitudes, int x) {
  const EnergyWeights& weights = energy_weights[band];
  return (context.energy[static_cast<std::size_t>(x)] + weights.left * magnitudes[x - 1] + weights.left2 * magnitudes[x - 2]) >> 4;
}

}  // namespace arete
