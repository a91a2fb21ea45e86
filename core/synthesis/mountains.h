#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

struct MountainOptions {
  double cell_size_m = 30;
  double relief_m = 2000;   ///< highest minus lowest cell
  double lowest_m = 400;
  std::uint64_t seed = 1;
  int threads = 0;          ///< 0: one per core; the result is the same for any number
};

/// A mountain range with valleys and ridges at every scale, in metres, without voids: spectral synthesis (spectral.h) gives
/// the massifs and the floors between them; from coarse to fine, streams incise (erosion.h) while the massifs rise, and what
/// becomes too steep slides. Made for examples and tests, not a model of a place. Any size; 1024 x 1024 takes about 1.7 s on two cores.
Raster<float> synthesize_mountains(Size size, const MountainOptions& options);

}  // namespace arete
