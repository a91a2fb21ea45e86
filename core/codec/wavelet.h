#pragma once

#include <array>
#include <cstdint>

#include "core/codec/subband_coder.h"
#include "core/terrain/raster.h"

namespace arete {

// The wavelet of the tree: biorthogonal, symmetric, four lifting steps of four taps each, made for terrain. The 9/7 wavelet
// (Cohen, Daubechies & Feauveau, 1992; lifting: Daubechies & Sweldens, 1998) is the case of two taps; the coefficients here
// minimise the bits of quantised bands over seven crops of real DEMs at 0.1, 0.4 and 1.5 bits a sample, and take 3 to 5 %
// off those of 9/7. The low-pass band keeps the elevation of constants; detail bands of constants are zero.
//
// Single precision without contraction and in a fixed order: the same result on every machine and for every window.
// Borders are mirrored about the first and the last sample. A level of w x h samples has ceil(w/2) x ceil(h/2) low-pass,
// floor(w/2) x ceil(h/2) horizontal, ceil(w/2) x floor(h/2) vertical and floor(w/2) x floor(h/2) diagonal coefficients.

/// Samples on each side that a window of coefficients or samples depends on; in coefficients, half as many.
inline constexpr int wavelet_reach = 12;

/// The norm of the elevations that one coefficient of size 1 at a level (1: the finest) stands for, band_count for low-pass.
/// A quantisation error of a coefficient counts in the squared error of the raster by its square.
float band_norm(int level, int band);

/// Size of a band (0 to 2, or band_count for the low-pass) of a level of the given size.
Size band_size(const Size& samples, int band);

/// One step from fine to coarse for a window of coefficients. `padded` has the samples from 2 x - wavelet_reach to
/// 2 (x + w) + wavelet_reach - 1 of both axes, mirrored by mirrored_index where they lie outside. The four views are
/// w x h; detail coefficients beyond a band's size are not meaningful.
void analyse(RasterView<const float> padded, RasterView<float> low, const std::array<RasterView<float>, band_count>& bands);

/// The inverse for a window of 2w x 2h samples from an even corner. `low` and `bands` have the coefficients from
/// x - wavelet_reach / 2 to x + w + wavelet_reach / 2 - 1, of both axes, mirrored by mirrored_index in sample positions.
void synthesise(RasterView<const float> low, const std::array<RasterView<const float>, band_count>& bands, RasterView<float> samples);

/// The sample inside [0, size) that stands for sample i when the signal is mirrored at its ends.
inline std::int64_t mirrored_index(std::int64_t i, std::int64_t size) {
  if (size == 1) return 0;
  const std::int64_t period = 2 * (size - 1);
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : period - i;
}

}  // namespace arete
