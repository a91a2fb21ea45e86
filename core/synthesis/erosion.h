#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

struct StreamErosionOptions {
  double cell_size_m = 30;
  int steps = 10;
  double step_years = 1;
  /// K and m of dh/dt = uplift - K A^m S with A, the drained area, in m^2 and S, the slope: m^(1-2m) per year.
  double erodibility = 1e-5;
  double area_exponent = 0.5;
  double least_area_m2 = 0;   ///< of A: hillslopes, which no stream drains, wear as if this much drained through them
  std::uint64_t seed = 1;     ///< of the directions of flow
  int threads = 0;            ///< 0: one per core; the result is the same for any number
};

/// Incises valleys by the stream-power law, dh/dt = U - K A^m S, solved implicitly from the mouth of each stream upwards, so that
/// any length of step is stable (Braun & Willett, Geomorphology 180, 2013, with n = 1). The terrain is periodic: what flows off
/// one side comes in at the opposite one. Cells whose `outlet` is not 0 keep their height; everything drains to them: water runs
/// down the steepest of the 8 slopes, where those of the diagonals are weighted by chance, so that valleys do not prefer the
/// directions of the grid (Rho8, Fairfield & Leymarie, Water Resources Research 27(5), 1991), and, out of a pit, over its lowest rim (priority flood, Barnes et al., Computers &
/// Geosciences 62, 2014). `terrain` in metres, without voids, changed in place; `uplift` in metres per year, same size;
/// fewer than 2^32 - 1 cells, at least one outlet. A priority queue's cost per step: about 0.3 us per cell.
void erode_by_streams(RasterView<float> terrain, RasterView<const float> uplift, RasterView<const unsigned char> outlet,
                      const StreamErosionOptions& options);

struct TalusOptions {
  double cell_size_m = 30;
  double talus_slope = 0.8;  ///< rise over run that loose rock keeps; 0.8 is 39 degrees
  int steps = 10;
  int threads = 0;           ///< 0: one per core; the result is the same for any number
};

/// Lets what is steeper than the talus slope slide to the lower neighbours (thermal erosion: Musgrave, Kolb & Mace, SIGGRAPH
/// 1989), in simultaneous steps on a periodic terrain. Mass is kept up to rounding; a terrain nowhere steeper is unchanged.
void settle_slopes(RasterView<float> terrain, const TalusOptions& options);

}  // namespace arete
