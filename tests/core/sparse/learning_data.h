#pragma once

#include <cmath>

#include <Eigen/Core>

#include "core/sparse/patches.h"
#include "core/support/random.h"

namespace arete {

/// Ridged hills with detail at every scale, metres; the same for the same seed.
inline Raster<float> hills(std::int64_t size, std::uint64_t seed) {
  Raster<float> terrain(size, size);
  for (std::int64_t y = 0; y < size; ++y)
    for (std::int64_t x = 0; x < size; ++x) {
      double z = 1000 + 0.2 * uniform_at(seed, x, y);
      for (int o = 0; o < 6; ++o)
        z += 60 * std::pow(0.5, o) * (1 - std::abs(std::sin(x * 0.04 * std::pow(1.9, o) + y * 0.01 + 6 * uniform_at(seed, o)))) *
             std::cos(y * 0.035 * std::pow(2.1, o) + 6 * uniform_at(seed, o, 1));
      terrain(x, y) = static_cast<float>(z);
    }
  return terrain;
}

inline Eigen::MatrixXf hill_patches(std::int64_t size, std::uint64_t seed, int cells, int pitch) {
  PatchOptions options;
  options.leave_out_flat = true;
  return extract_patches(hills(size, seed).view(), make_patch_grid(cells, pitch), options).values;
}

}  // namespace arete
