#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/codec/node_cache.h"
#include "core/codec/node_grid.h"
#include "core/codec/subband_coder.h"
#include "core/terrain/raster.h"

namespace arete {

// A raster as a tree of wavelet coefficients: the lossy coder of .sct for a wanted PSNR, error or size.

/// What a decoder must know beside the streams.
struct WaveletParameters {
  NodeGrid grid;
  float step = 1;  ///< of the trellis quantiser, in metres of a detail of norm 1; finite, > 0
  /// How far magnitudes of 1, 2, and 3 or more lie towards zero of their lattice points, in 1/256 of a step.
  std::array<std::uint8_t, 3> shrink{};
  bool flat = false;  ///< streams carry flat water (core/codec/flat_coder.h) before the coefficients; the coder does not look at it
};

/// The parameters as bytes, but for the grid; and back. Safe for untrusted bytes: throws Error{damaged}, `name` being the file.
std::vector<std::byte> encode_wavelet_parameters(const WaveletParameters& parameters);
WaveletParameters decode_wavelet_parameters(std::span<const std::byte> bytes, const NodeGrid& grid, const std::string& name);

/// The coefficients of a band that a node holds.
Window node_band(const NodeGrid& grid, const NodeAddress& node, int band);
/// The coefficients of a node, all zero, with the sizes that the node has.
NodeCoefficients blank_coefficients(const NodeGrid& grid, const NodeAddress& node);
/// Where a node's contexts find its parent.
ParentView view_parent(const NodeGrid& grid, const NodeAddress& node, const NodeCoefficients* parent);

using CoefficientCache = NodeCache<NodeCoefficients>;

/// A window of a level, 0 to grid.levels(); metres. Touches only the nodes that the window depends on, and of those only what
/// `cache` (may be null) has not. The same values for any window and any number of threads. Safe for untrusted streams; values may then be anything, infinite and NaN included.
Raster<float> decode_wavelet(const WaveletParameters& parameters, std::span<const std::byte> root, const StreamReader& streams, int level,
                             const Window& window, int threads, CoefficientCache* cache = nullptr);

}  // namespace arete
