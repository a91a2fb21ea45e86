#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/codec/predict_planes.h"
#include "core/codec/predict_residual.h"
#include "core/codec/predict_rows.h"

namespace arete {

// One phase of a node, row by row. What is coded, and whether at all, is up to the caller: the encoder, the decoder and the
// estimation of parameters walk the same way.

/// What a row's residuals are predicted from and leave behind for the next one.
template <typename Sum>
struct PhaseRows {
  explicit PhaseRows(int width)
      : filtered(row_length(width)), residuals(row_length(width)), above(row_length(width)), expected(row_length(width)),
        spread(row_length(width)), curvature(row_length(width)), around(row_length(width)) {}
  static constexpr int margin = Plane<std::int32_t>::margin;
  static std::size_t row_length(int width) { return static_cast<std::size_t>(width + 2 * margin + Plane<std::int32_t>::slack); }
  Sum* filtered_row() { return filtered.data() + margin; }
  Sum* residual_row() { return residuals.data() + margin; }
  Sum* residual_row_above() { return above.data() + margin; }
  ActivityRow activity() { return {expected.data(), spread.data(), curvature.data(), around.data()}; }

  void next_row() {
    std::swap(residuals, above);
    std::fill(residuals.begin(), residuals.end(), Sum{0});
  }

  std::vector<Sum> filtered;
  std::vector<Sum> residuals;  ///< decoded minus filtered value, 1/16; 0 outside the block and at voids
  std::vector<Sum> above;
  std::vector<std::uint32_t> expected;
  std::vector<std::int32_t> spread;
  std::vector<std::int32_t> curvature;
  std::vector<std::int32_t> around;
};

struct Prediction {
  std::int32_t value;
  int lean;  ///< how far above `value` it was before it was rounded, 1/16: -8 to 7 but at the ends of the range
};

/// The prediction of cell x of a row: the filter's result, corrected by the residuals around.
template <typename Sum>
Prediction predict_cell(PhaseRows<Sum>& rows, int x, const PredictParameters& file, const PhaseParameters& parameters) {
  const Sum* here = rows.residual_row();
  const Sum* above = rows.residual_row_above();
  const Sum correction = parameters.recursion[0] * here[x - 1] + parameters.recursion[1] * above[x] +
                         parameters.recursion[2] * above[x - 1] + parameters.recursion[3] * above[x + 1];
  const Sum fine = rows.filtered_row()[x] + ((correction + 128) >> 8);
  const Sum prediction = std::clamp<Sum>((fine + 8) >> filter_bits, file.lowest, file.highest);
  return {static_cast<std::int32_t>(prediction), static_cast<int>(std::clamp<Sum>(fine - prediction * 16, -8, 7))};
}

/// The decoded value for a residual of `index` steps; whatever the index, it is in the range of the file.
inline std::int32_t add_steps(std::int32_t prediction, std::int64_t index, std::int32_t step, const PredictParameters& file) {
  index = std::clamp<std::int64_t>(index, -(std::int64_t{1} << 33), std::int64_t{1} << 33);
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(prediction + index * step, file.lowest, file.highest));
}

/// The residual of `value` in steps, so that prediction + index * step - value is in [-(step - 1 - step / 2), step / 2].
inline std::int64_t residual_steps(std::int32_t value, std::int32_t prediction, std::int32_t step) {
  const std::int64_t difference = std::int64_t{value} - prediction + step / 2;
  return difference >= 0 ? difference / step : -((-difference + step - 1) / step);
}

/// Leaves a cell's result for those after it.
template <typename Sum>
void keep_cell(PhaseRows<Sum>& rows, int x, std::int32_t decoded, std::int64_t index, std::int32_t step, std::int32_t* values,
               std::int32_t* magnitudes) {
  const std::int64_t magnitude = index < 0 ? -index : index;
  values[x] = decoded;
  rows.residual_row()[x] = Sum{decoded} * 16 - rows.filtered_row()[x];
  magnitudes[x] = static_cast<std::int32_t>(std::min<std::int64_t>(std::min<std::int64_t>(magnitude, magnitude_limit) * step, magnitude_limit));
}

/// What all cells of a phase have in common.
struct PhaseContext {
  const PhaseParameters& parameters;
  std::int32_t step;
  int log_step;  ///< quarter_log2(step)
  int phase;     ///< 0 to 2
};

/// What the residual of cell x is coded under. `lean`: of its prediction; `western` and `northern`: the magnitudes at x - 1 and above.
template <typename Sum>
ResidualContext residual_context(PhaseRows<Sum>& rows, int x, int lean, std::int32_t western, std::int32_t northern, const PhaseContext& of) {
  const auto i = static_cast<std::size_t>(x);
  const std::uint32_t expected = rows.expected[i] + of.parameters.activity[0] * static_cast<std::uint32_t>(western);
  const int log_expected = quarter_log2(expected) - 32 - of.log_step;  // of the expected magnitude in steps
  ResidualContext context;
  context.phase = of.phase;
  context.shift = std::clamp((log_expected - 3) >> 2, 0, 24);
  context.scale = std::clamp(log_expected - 4 * context.shift + unshifted_scale, 0, residual_scales - 1);
  context.lean = lean / of.step + 8;
  const auto against = [&](std::int32_t magnitude) {  // 1/2, 3/2 and 3 times the expected one
    const std::uint64_t twice = static_cast<std::uint64_t>(magnitude) * 512;
    return (twice > expected) + (twice > std::uint64_t{3} * expected) + (twice > std::uint64_t{6} * expected);
  };
  context.beside = against(western) * 4 + against(northern);
  const auto level = [&](std::int32_t feature, int shown) {
    return std::clamp(((quarter_log2(static_cast<std::uint64_t>(feature) * 16 + 1) - 16 - of.log_step) >> 1) + shown, 0, 15);
  };
  context.relief = level(rows.spread[i], 4) * 16 + level(rows.curvature[i], 6);
  context.wide = std::clamp((quarter_log2(static_cast<std::uint64_t>(rows.around[i]) * 4 + 1) - of.log_step - 6) >> 1, 0, 23);
  const auto side = [&](Sum residual) { return residual > 4 * Sum{of.step} ? 2 : residual < -4 * Sum{of.step} ? 0 : 1; };
  context.turn = side(rows.residual_row()[x - 1]) * 3 + side(rows.residual_row_above()[x]);
  return context;
}

}  // namespace arete
