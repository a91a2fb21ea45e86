#include "core/amplify/activity.h"

#include <cassert>
#include <cmath>

#include "core/sparse/patch_grid.h"

namespace arete {

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
  return static_cast<float>(std::sqrt(std::sqrt(gradient * curvature)));
}

}  // namespace arete
