#pragma once

#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// Splits the detail above the Nyquist frequency of cells `factor` times larger into its octaves, finest first, by differences of
/// binomial filters (1 4 6 4 1)/16 with holes (the a trous algorithm, Holschneider et al. 1989); what the last filter passes, below the
/// coarse Nyquist frequency, is dropped. Void cells count as 0 and stay out of no sum: mask the result.
std::vector<Raster<float>> split_octaves(RasterView<const float> detail, int factor, int threads);

}  // namespace arete
