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

constexpr int energy_bin(int sixteenths) {
  if (sixteenths < 2) return 0;
  const int octave = std::bit_width(static_cast<unsigned>(sixteenths)) - 1;
  const int fraction = octave >= 2 ? (sixteenths >> (octave - 2)) & 3 : (sixteenths << (2 - octave)) & 3;
  return std::clamp(4 * octave + fraction - 2, 0, energy_bins - 1);
}

constexpr int local_bin(int sum) {
  constexpr std::array<std::uint8_t, 26> table{0, 1, 2, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 7};
  return table[static_cast<std::size_t>(std::min(sum, 25))];
}

inline int sign_of(std::int32_t value) { return (value > 0) - (value < 0); }

/// From here on all sums of magnitudes are in one bin.
inline constexpr int near_limit = 25;

/// What a place has around it in the rows above, the bands before and the parent.
struct PlaceContext {
  std::uint16_t energy;  ///< weighted magnitudes, 1/256
  std::uint8_t near;     ///< half of twice up, up-left and up-right; held to near_limit
  std::uint8_t cross;    ///< bin of the other bands' and the parent's magnitudes
};
inline PlaceContext unpack_place(std::uint32_t packed) {
  return {static_cast<std::uint16_t>(packed), static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 24)};
}

/// What of a row's contexts is known before the row is coded.
struct RowContext {
  std::vector<std::uint32_t> places;  ///< packed PlaceContext
  std::vector<std::int32_t> signs;    ///< 256 times what the rows above add to the predicted coefficient (1/256), and to the pattern of signs
  std::vector<std::uint16_t> energy, others;  ///< sums on their way
  explicit RowContext(int width);
};

/// Columns [first, end) of a row, `first` even.
struct Columns {
  int first, end;
};

/// Fills the places of columns of row y of a band.
void prepare_places(const NodeCoefficients& node, const ParentView& parent, int band, int y, Columns columns, RowContext& context);
/// The same, and the signs.
void prepare_row(const NodeCoefficients& node, const ParentView& parent, int band, int y, Columns columns, RowContext& context);

/// The expected magnitude of a place, in 1/16, with what is left of it in the row: `left` and `left2` are magnitudes held to 255.
/// The weights of a band sum to less than 257, so that 16 bits hold the sum.
inline unsigned expected_magnitude(PlaceContext place, int band, int left, int left2) {
  const EnergyWeights& weights = energy_weights[band];
  return static_cast<unsigned>(place.energy + weights.left * left + weights.left2 * left2) >> 4;
}

/// Energy bins of all expected magnitudes.
inline constexpr auto energy_bin_table = [] {
  std::array<std::uint8_t, 4096> table{};
  for (int e = 0; e < 4096; ++e) table[static_cast<std::size_t>(e)] = static_cast<std::uint8_t>(energy_bin(e));
  return table;
}();

/// Runs of columns whose squares are on, in the row of squares `strip`: visit(Columns).
template <class Visit>
void visit_runs(const CoefficientBlock& block, int strip, Visit visit) {
  const std::uint8_t* flags = block.flags(strip);
  for (int b = 0; b < block.squares_wide(); ++b) {
    if (!flags[b]) continue;
    const int first = b;
    while (b < block.squares_wide() && flags[b]) ++b;
    visit(Columns{first * CoefficientBlock::square, std::min(b * CoefficientBlock::square, block.width())});
  }
}

}  // namespace arete
