#pragma once

#include <optional>
#include <span>

namespace arete {

/// One measured point of a codec: what it spent and what it gave.
struct RatePoint {
  double bits = 0;  ///< per sample, above 0
  double psnr = 0;  ///< dB
};

// The differences between two codecs that Bjontegaard defined (G. Bjontegaard, "Calculation of average PSNR differences between
// RD-curves", VCEG-M33, 2001), between curves that are not his cubic but a piecewise cubic without overshoot (Fritsch & Butland 1984,
// PCHIP), as JCT-VC and its successors do: PSNR over log10(bits), or log10(bits) over PSNR. Points may come in any order; those that
// are not finite, and those that do not rise in both bits and PSNR above the points before them, are left out.

/// How many dB `test` lies above `anchor` on average, over the logarithm of the rates that both reach, inside [lowest, highest] bits per
/// sample. Nullopt where a curve has fewer than two points or the curves have no rates in common.
std::optional<double> bd_psnr(std::span<const RatePoint> anchor, std::span<const RatePoint> test, double lowest = 0,
                              double highest = 1e300);

/// How many percent more (above 0) or fewer (below 0) bits `test` takes than `anchor` on average, over the PSNR that both reach.
/// Nullopt as bd_psnr.
std::optional<double> bd_rate(std::span<const RatePoint> anchor, std::span<const RatePoint> test);

}  // namespace arete
