#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

struct SpectralOptions {
  /// Exponent of the amplitude: amplitude falls as f^-beta, power as f^(-2 beta). A fractional Brownian surface with Hurst
  /// exponent H has beta = H + 1; mountains lie near 2.
  double beta = 2;
  double relief_m = 1;       ///< highest minus lowest cell of the result, which begins at 0
  std::uint64_t seed = 1;
  int threads = 0;           ///< 0: one per core; the result is the same for any number
};

/// Terrain by spectral synthesis (Voss, Fractals in nature, in: The Science of Fractal Images, 1988): white Gaussian noise whose
/// spectrum is multiplied by f^-beta, f being the distance to zero of the wrapped frequency, in cycles per cell, so that the
/// grain has no direction and cells need not be square in number. Periodic in x and y, no void. The mean (f = 0) is dropped.
/// Any size from 1 x 1; cells are transformed in double: 16 bytes a cell, cost of two FFTs.
Raster<float> synthesize_spectral(Size size, const SpectralOptions& options);

}  // namespace arete
