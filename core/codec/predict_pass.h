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
        spread(row_length(width)), curvature(row_length(width)), classes(row_length(width)), classes_above(row_length(width)) {}
  static constexpr int margin = Plane<std::int32_t>::margin;
  static std::size_t row_length(int width) { return static_cast<std::size_t>(width + 2 * margin + Plane<std::int32_t>::slack); }
  Sum* filtered_row() { return filtered.data() + margin; }
  Sum* residual_row() { return residuals.data() + margin; }
  Sum* residual_row_above() { return above.data() + margin; }
  std::uint8_t* class_row() { return classes.data() + margin; }
  std::uint8_t* class_row_above() { return classes_above.data() + margin; }
  ActivityRow activity() { return {expected.data(), spread.data(), curvature.data()}; }

  void next_row() {
    std::swap(residuals, above);
    std::swap(classes, classes_above);
    std::fill(residuals.begin(), residuals.end(), Sum{0});
    std::fill(classes.begin(), classes.end(), std::uint8_t{0});
  }

  std::vector<Sum> filtered;
  std::vector<Sum> residuals;  ///< decoded minus filtered value, 1/16; 0 outside the block and at voids
  std::vector<Sum> above;
  std::vector<std::uint32_t> expected;
  std::vector<std::int32_t> spread;
  std::vector<std::int32_t> curvature;
  std::vector<std::uint8_t> classes;  ///< min(|residual / step|, 2)
  std::vector<std::uint8_t> classes_above;
};

/// The prediction of cell x of a row: the filter's result, corrected by the residuals around.
template <typename Sum>
std::int32_t predict_cell(PhaseRows<Sum>& rows, int x, const PredictParameters& file, const PhaseParameters& parameters) {
  const Sum* here = rows.residual_row();
  const Sum* above = rows.residual_row_above();
  const Sum correction = parameters.recursion[0] * here[x - 1] + parameters.recursion[1] * above[x] +
                         parameters.recursion[2] * above[x - 1] + parameters.recursion[3] * above[x + 1];
  const Sum prediction = (rows.filtered_row()[x] + ((correction + 128) >> 8) + 8) >> filter_bits;
  return static_cast<std::int32_t>(std::clamp<Sum>(prediction, file.lowest, file.highest));
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
  rows.class_row()[x] = static_cast<std::uint8_t>(std::min<std::int64_t>(magnitude, 2));
  magnitudes[x] = static_cast<std::int32_t>(std::min<std::int64_t>(std::min<std::int64_t>(magnitude, magnitude_limit) * step, magnitude_limit));
}

/// What the residual of cell x is coded under. `western`: the magnitude at x - 1; `log_step`: quarter_log2(step).
template <typename Sum>
ResidualContext residual_context(PhaseRows<Sum>& rows, int x, std::int32_t western, const PhaseParameters& parameters, int log_step) {
  const std::uint32_t expected = rows.expected[static_cast<std::size_t>(x)] + parameters.activity[0] * static_cast<std::uint32_t>(western);
  const int log_expected = quarter_log2(expected) - 32 - log_step;  // of the expected magnitude in steps
  ResidualContext context;
  if (log_expected >= 2) {
    context.shift = std::min((log_expected + 2) >> 2, 24);
    context.scale = 28 + (log_expected & 3);
    return context;
  }
  context.scale = std::max(0, log_expected + 24);
  context.neighbours = (context.scale >> 1) * 9 + rows.class_row()[x - 1] * 3 + rows.class_row_above()[x];
  const auto level = [&](std::int32_t feature, int highest) {
    const int relative = (quarter_log2(static_cast<std::uint64_t>(feature) * 16 + 1) - 16 - log_step) >> 1;
    return std::clamp(relative + 4, 0, highest);
  };
  context.relief = level(rows.spread[static_cast<std::size_t>(x)], 15) * 8 + level(rows.curvature[static_cast<std::size_t>(x)], 7);
  return context;
}

}  // namespace arete
