#pragma once

#include <array>
#include <cstdint>

#include "core/codec/predict_planes.h"

namespace arete {

// The parts of prediction that need nothing from the row itself, a row at a time, vectorised. Integers only; sums of the
// narrow kind are exact in 32 bits (PredictParameters::narrow), those of the wide kind in 64.

/// A tap and, through the cell, its mirror image. In cells of level l - 1.
struct TapPair {
  int dx;
  int dy;
};
/// The taps of the coded phases, nearest first.
inline constexpr std::array<std::array<TapPair, filter_pairs>, coded_phases> tap_pairs = {{
    {{{1, 1}, {1, -1}, {3, 1}, {3, -1}, {1, 3}, {1, -3}, {3, 3}, {3, -3}, {5, 1}, {5, -1}, {1, 5}, {1, -5}}},
    {{{1, 0}, {0, 1}, {2, 1}, {2, -1}, {1, 2}, {1, -2}, {3, 0}, {0, 3}, {3, 2}, {3, -2}, {2, 3}, {2, -3}}},
    {{{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {2, -1}, {1, 2}, {1, -2}, {3, 0}, {0, 3}, {3, 1}, {3, -1}, {1, 3}, {1, -3}}},
}};
inline constexpr std::array<int, coded_phases> pair_count = {12, 12, 14};

/// Where the neighbour at (dx, dy) of a cell of a phase lies: the phase that it belongs to, and the offset in that plane.
struct PlaneOffset {
  int phase;
  int dx;
  int dy;
};
constexpr PlaneOffset locate(int phase, int dx, int dy) {
  const int x = odd_x(phase) + dx, y = odd_y(phase) + dy;
  const int to = (x & 1) != 0 ? ((y & 1) != 0 ? 1 : 2) : ((y & 1) != 0 ? 3 : 0);
  return {to, (x - odd_x(to)) >> 1, (y - odd_y(to)) >> 1};
}

/// How far beyond the block a phase must be predicted for the phases after it.
inline constexpr std::array<int, 4> phase_margin = {8, 4, 2, 0};

/// Fixed point of a filtered value: 1/16.
inline constexpr int filter_bits = 4;

/// The filter over cells [-margin, width + margin) of row y, margin = phase_margin[phase]: into `filtered` in 1/16, held to the
/// range of values, and rounded into the phase's plane. `Sum` is int32 (narrow) or int64.
template <typename Sum>
void filter_row(NodePlanes& planes, int phase, int y, const PredictParameters& file, const PhaseParameters& parameters, Sum* filtered);

/// What is known of a row's activity before its own residuals are: for cells [0, count).
struct ActivityRow {
  std::uint32_t* expected;   ///< the expected magnitude in 1/256 of a unit without the western neighbour's share
  std::int32_t* spread;      ///< of the four nearest values
  std::int32_t* curvature;   ///< the filter's result against the mean of the four nearest
  std::int32_t* around;      ///< the sum of 20 magnitudes of the centre phase around; of the centre phase itself, twice ten above
};
template <typename Sum>
void measure_activity(const NodePlanes& planes, int phase, int y, int count, const PhaseParameters& parameters, const Sum* filtered,
                      const ActivityRow& out);

/// The features that the activity weights 0 to 8 weigh, for one cell: weight 0 is the western neighbour's. For training.
template <typename Sum>
std::array<std::int32_t, activity_weights> activity_features(const NodePlanes& planes, int phase, int x, int y, Sum filtered);

}  // namespace arete
