#pragma once

#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// A linear upsampler learned from terrain. It is exactly consistent: each fine block keeps the mean of its coarse cell; and exact on
/// planes. Fine cell p = py f + px of the block of coarse cell c is
///   z(c) + sum over taps k of weights[p T + k] (z(c + k) - z(c)),
/// T = (2 reach + 1)^2 taps, row-major from (-reach, -reach).
struct Upsampler {
  int factor = 0;
  int reach = 0;
  std::vector<float> weights;  ///< f^2 x T
  int side() const { return 2 * reach + 1; }
};

/// How far the learned neighbourhood reaches, in coarse cells: 9 x 9 taps; 11 x 11 and 13 x 13 bring less than 0.1 % of RMSE.
inline constexpr int default_reach = 4;

/// Learns the upsampler by which the area averages of the terrains give back the terrains with least squares: ridge regression of the
/// block's deviations from its mean on the differences of the neighbours, over all cells with a whole neighbourhood, in their 8
/// rotations and mirrors, cells weighted by 1 / (energy + mean energy) so that calm terrain counts too; under the constraints that
/// a plane gives a plane. Cost: 7 k multiply-adds per coarse cell; exemplars beyond `most_training_cells` coarse cells are
/// thinned by rows. Without enough cells to learn from (fewer than 4 T in all) the weights are those of the smoothest
/// consistent answer, the ridge alone: it stays consistent and exact on planes.
Upsampler train_upsampler(const std::vector<RasterView<const float>>& terrains, int factor, int reach = default_reach);
inline constexpr std::int64_t most_training_cells = 200'000;

/// Upsamples a window of coarse cells. `coarse` is the window with a margin of `reach` cells on every side; `fine` is factor times the
/// window. On entry `fine` holds detail e to be added, on return z' = U(z - D e) + e, D the area average given as `detail_mean` (same
/// geometry as `coarse`): the area average of the result is z, to the rounding of one float. `detail_mean.data` null: e is taken
/// as 0 and `fine` is overwritten. Cells whose neighbourhood has a NaN become NaN. A cell does not depend on the window.
void upsample(const Upsampler& upsampler, RasterView<const float> coarse, RasterView<const float> detail_mean, RasterView<float> fine,
              int threads = 1);

/// The whole of a coarse terrain, borders and voids continued by extend_into_voids; void cells stay void.
Raster<float> upsample_whole(const Upsampler& upsampler, RasterView<const float> coarse, int threads = 0);

}  // namespace arete
