#include "core/amplify/activity.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/sparse/patch_grid.h"

namespace arete {
namespace {

/// What the curvature <|H z|^2> of a plane can seem to be by the rounding of its elevations: half a spacing (2^-23 relative) in each sample gives
/// |xx|, |yy| of 2 spacings, |xy| of 1/2, 8.5 in the squared norm; twice that for planes that were continued. The fourth root would
/// make 1 cm of detail of the 0.2 mm of rounding at 3000 m.
double rounding_curvature(const float* cells, int count) {
  double height = 0;
  for (int i = 0; i < count; ++i) height = std::max(height, std::abs(static_cast<double>(cells[i])));
  const double spacing = 0x1p-23 * height;
  return 17 * spacing * spacing;
}

}  // namespace

ActivityMeter::ActivityMeter(int patch_cells) : cells_(patch_cells) {
  assert(patch_cells >= 4);
  const std::vector<float> disc = disc_weights(patch_cells);
  double sum = 0;
  for (int y = 1; y + 1 < patch_cells; ++y)
    for (int x = 1; x + 1 < patch_cells; ++x) {
      weights_.push_back(static_cast<double>(disc[static_cast<std::size_t>(y * patch_cells + x)]));
      sum += weights_.back();
    }
  for (double& w : weights_) w /= sum;
}

float ActivityMeter::measure(const float* cells) const {
  const int m = cells_;
  double gradient = 0, curvature = 0;
  std::size_t k = 0;
  for (int y = 1; y + 1 < m; ++y)
    for (int x = 1; x + 1 < m; ++x, ++k) {
      const auto at = [&](int i, int j) { return static_cast<double>(cells[(y + j) * m + x + i]); };
      const double gx = (at(1, 0) - at(-1, 0)) / 2, gy = (at(0, 1) - at(0, -1)) / 2;
      const double xx = at(1, 0) + at(-1, 0) - 2 * at(0, 0), yy = at(0, 1) + at(0, -1) - 2 * at(0, 0);
      const double xy = (at(1, 1) + at(-1, -1) - at(1, -1) - at(-1, 1)) / 4;
      gradient += weights_[k] * (gx * gx + gy * gy);
      curvature += weights_[k] * (xx * xx + yy * yy + 2 * xy * xy);
    }
  // (A NaN stays one.)
  const double relief = curvature - rounding_curvature(cells, m * m);
  return static_cast<float>(std::sqrt(std::sqrt(gradient * (relief < 0 ? 0 : relief))));
}

}  // namespace arete
