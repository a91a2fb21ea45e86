#pragma once

#include <cstdint>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// Power of a frequency band, lower <= |k| < upper in cycles per cell (radial), in m^2.
struct BandPower {
  double lower = 0, upper = 0;
  double reference = 0, result = 0;
  double ratio() const { return result / reference; }  ///< NaN when the reference has no power there
};

/// Radially averaged power spectra of two rasters on the same tiles.
struct SpectrumComparison {
  std::int64_t tile = 0;    ///< side of the tiles in cells; 0 when no tile without voids was found
  std::int64_t tiles = 0;   ///< averaged
  double coverage = 0;      ///< share of the cells valid in both that lie in a tile
  /// Density at |k| = i / tile cycles per cell (rings one bin wide), i = 0 .. tile / 2, in m^2 per (cycle/cell)^2.
  std::vector<double> reference, result;
  std::vector<BandPower> bands;  ///< the octaves above the input's Nyquist frequency, lowest first
};

struct SpectrumOptions {
  int factor = 4;           ///< of the amplification: bands go up from 1/(2 factor)
  std::int64_t tile = 256;  ///< wanted side, a power of two, 16 to 4096
  std::int64_t border = 0;  ///< leaves out that many cells along each side
  int threads = 0;          ///< 0: one per core; the result is the same for any number
};

/// The octaves from 1/(2 factor) up to 1/2 cycle per cell, the last one cut at 1/2: factor 4 has [1/8, 1/4) and [1/4, 1/2),
/// factor 3 [1/6, 1/3) and [1/3, 1/2). Powers are 0. factor >= 2.
std::vector<BandPower> octaves_above_nyquist(int factor);

/// Power spectra by Welch's method (The use of fast Fourier transform..., IEEE Trans. Audio Electroacoust. 15(2), 1967): tiles
/// that overlap by half, each less its least-squares plane, times a Hann window, and transformed; powers are averaged.
/// Tiles with a cell that is void in either raster are left out. The side is the largest power of two up to `tile` whose tiles
/// cover half of the cells valid in both; when none does, the one that covers most (16 at least). Tiles begin at multiples of
/// half a side from the border: a strip narrower than that may stay out. Frequencies beyond 1/2 (the corners) belong to no
/// band. Without any tile `tile` is 0 and the ratios are NaN.
/// Memory: a few tiles per thread, one bit per 64 cells. Sums in double and in a fixed order.
/// Throws Error{input} when the sizes differ.
SpectrumComparison compare_spectra(const RasterSource& reference, const RasterSource& result, const SpectrumOptions& options,
                                   Progress& progress);
SpectrumComparison compare_spectra(RasterView<const float> reference, RasterView<const float> result,
                                   const SpectrumOptions& options);

}  // namespace arete
