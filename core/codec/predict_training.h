#pragma once

#include <span>

#include "core/codec/predict_node.h"

namespace arete {

/// A node to learn from: the arguments of encode_node.
struct TrainingBlock {
  LevelView coarse;
  Window cells;
  BlockView truth;
};

/// Parameters that suit a level: taps by weighted least squares, one phase after the other on what the phases before decode to;
/// recursion weights by least squares on the residuals left; activity weights so that the expected magnitudes are
/// proportional to the true ones. Blocks are a sample of the level's; a million cells are plenty. The coarse
/// cells are as decoded. Uses file.lowest and highest only. The same result for any number of threads. Levels with too
/// few cells to learn from receive `fallback`'s taps and weights. Cost: about 0.3 us a cell.
LevelParameters estimate_level(std::span<const TrainingBlock> blocks, const PredictParameters& file, std::int32_t step,
                               const LevelParameters& fallback, int threads);

}  // namespace arete
