#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/codec/predict_node.h"

namespace arete {

/// Codes the coarsest level, NodeGrid::root_side cells along an axis at most, each cell predicted from the ones to the west and
/// north, in steps of file.root_step. Takes and gives what encode_node does, with the same guarantee.
std::vector<std::byte> encode_root(const PredictParameters& file, const BlockView& truth, RasterView<std::int32_t> decoded);

/// The inverse. Safe for untrusted bytes.
void decode_root(const PredictParameters& file, std::span<const std::byte> bytes, RasterView<const std::uint8_t> voids,
                 RasterView<std::int32_t> decoded);

}  // namespace arete
