#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/codec/predict_parameters.h"
#include "core/codec/predict_planes.h"
#include "core/codec/predict_residual.h"

namespace arete {

// A node of the predictive coder: the cells of level l - 1 over a square, given level l. Each cell is predicted by a linear
// filter over the cells known on all sides, the prediction corrected by the residuals just coded, and the residual from it,
// a multiple of the level's step, coded under the magnitude that the surroundings let expect. The coder sees only what the
// decoder will: errors do not add up, and each decoded value is within half a step of the true one.

/// A block of level l - 1 as it is: where `voids` is 1, the value does not matter. `voids` data null: no cell is void.
struct BlockView {
  RasterView<const std::int32_t> values;
  RasterView<const std::uint8_t> voids;
};

/// Codes the cells of a block that level l has not. `cells`: the block, NodeGrid::cells; `coarse`: level l as it will be
/// decoded, within lattice_margin of the block; `truth`: the block's values, in [lowest, highest] where they are not void.
/// `decoded` receives what decode_node will give. Guarantee: for step s, decoded - truth is in [-(s - 1 - s / 2), s / 2] at
/// each cell coded here that is not void. Empty where all residuals are zero.
std::vector<std::byte> encode_node(const LevelView& coarse, const Window& cells, const PredictParameters& file,
                                   const LevelParameters& level, const BlockView& truth, RasterView<std::int32_t> decoded);

/// The same with models of the caller's, which keep what they learn: for the training of first states.
std::vector<std::byte> encode_node(const LevelView& coarse, const Window& cells, const PredictParameters& file, const LevelParameters& level,
                                   const BlockView& truth, ResidualModels& models, RasterView<std::int32_t> decoded);

/// The block of level l - 1, with the cells of level l among it. Void cells receive any value. Safe for untrusted bytes: they give
/// some values of [lowest, highest]. Cost: about 100 ns a cell where residuals are several steps, 50 ns where they are mostly zero.
void decode_node(const LevelView& coarse, const Window& cells, const PredictParameters& file, const LevelParameters& level,
                 std::span<const std::byte> bytes, RasterView<const std::uint8_t> voids, RasterView<std::int32_t> decoded);

}  // namespace arete
