#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/codec/node_grid.h"
#include "core/codec/predict_node.h"

namespace arete {

// A raster of whole numbers by closed-loop prediction, level by level: the coder of .sct for a strict bound, lossless at a step
// of 1. What the numbers stand for, and which cells are void, is the caller's. Laid out to the bit in
// core/codec/predictive-format.md.

/// A window of the mask of a level: 1 where void. Called from several threads.
using VoidReader = std::function<Raster<std::uint8_t>(int level, const Window& window)>;

struct PredictiveStreams {
  NodeGrid grid;
  PredictParameters parameters;
  std::vector<std::byte> root;
  std::vector<std::vector<std::byte>> nodes;  ///< by NodeGrid::index; empty where all residuals are zero
  Raster<std::int32_t> decoded;               ///< level 0 as the decoder will give it
  std::int64_t bytes() const;                 ///< of the streams and of the parameters
};

struct PredictiveOptions {
  std::int32_t step = 1;  ///< 1 to 2^24. Decoded minus true is in [-(step - 1 - step / 2), step / 2]
  /// The step of level l >= 1 is step x coarse_step[min(l, size) - 1] / 256, 1 at least: finer where others are predicted from.
  std::vector<int> coarse_step;
  int threads = 0;
};

/// Encodes a raster, void where `voids` is 1 (data null: nowhere); values of void cells do not matter. The same bytes for any number of
/// threads. Memory: about 12 bytes a cell.
PredictiveStreams encode_predictive(RasterView<const std::int32_t> values, RasterView<const std::uint8_t> voids, const NodeGrid& grid,
                                    const PredictiveOptions& options);

/// A window of a level, 0 to grid.levels(); void cells have any value. `voids` is empty where the raster has none. Touches only the
/// nodes that the window depends on. The same values for any window and any number of threads. Safe for untrusted streams.
Raster<std::int32_t> decode_predictive(const NodeGrid& grid, const PredictParameters& parameters, std::span<const std::byte> root,
                                       const StreamReader& streams, const VoidReader& voids, int level, const Window& window, int threads);

}  // namespace arete
