#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/codec/wavelet_coder.h"

namespace arete {

// The coarsest level of a tree of wavelet coefficients: quantised low-pass values, each coded as its difference to the one before.

/// A number of steps that an index has room for. A step that is too fine for a value, or a value beyond a float, costs quality, which whoever asked
/// for it measures.
inline float hold_steps(float steps, float most) { return std::isnan(steps) ? 0.0F : std::clamp(steps, -most, most); }

/// `root`: the low-pass of the coarsest level.
std::vector<std::byte> encode_wavelet_root(const Raster<float>& root, const WaveletParameters& parameters);

/// The inverse, as quantised. Safe for untrusted bytes.
Raster<float> decode_wavelet_root(std::span<const std::byte> bytes, const WaveletParameters& parameters);

}  // namespace arete
