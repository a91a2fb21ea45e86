#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/codec/node_cache.h"
#include "core/codec/node_grid.h"
#include "core/codec/predict_node.h"

namespace arete {

// A raster of whole numbers by closed-loop prediction, level by level: the coder of .sct for a strict bound, lossless at a step
// of 1. What the numbers stand for, and which cells are void, is the caller's. Laid out to the bit in
// core/codec/predictive-format.md.

/// A window of the mask of a level: 1 where void. Called from several threads.
using VoidReader = std::function<Raster<std::uint8_t>(int level, const Window& window)>;

/// Blocks of nodes.
using NumberCache = NodeCache<Raster<std::int32_t>>;

/// A window of a level, 0 to grid.levels(); void cells have any value. `voids` is empty where the raster has none. Touches only the
/// nodes that the window depends on, and of those only what `cache` (may be null) has not. The same values for any window and any number of threads. Safe for untrusted streams.
Raster<std::int32_t> decode_predictive(const NodeGrid& grid, const PredictParameters& parameters, std::span<const std::byte> root,
                                       const StreamReader& streams, const VoidReader& voids, int level, const Window& window, int threads,
                                       NumberCache* cache = nullptr);

}  // namespace arete
