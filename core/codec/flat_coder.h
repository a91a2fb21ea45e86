#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/codec/node_grid.h"
#include "core/codec/void_mask_coder.h"
#include "core/terrain/value_type.h"

namespace arete {

// Dead-flat water behind a lossy coder: which cells are flat (find_flat_water), by the mask of core/codec/void_mask_coder.h with 1 where
// flat, and the few stored values that they have. A flat cell's value is the one of its node's list that lies nearest to what the
// lossy coder decoded there (before it is rounded to the type). Bytes: core/codec/flat-format.md.

/// Longest list of a node, of the values that most of its cells have. keep_reached takes the cells of rarer ones out.
inline constexpr int most_flat_values = 64;

/// The value of a non-empty list in rising order that is nearest to `decoded`; of two as near the first; the first for NaN.
double nearest_flat(std::span<const double> list, double decoded);

/// Takes out of the mask of level 0 what the rule would give another value, so that what stays comes back bit for bit. `values` and
/// `decoded` are the stored numbers of the node's block, of a node of level 1; `fine` holds the block at least. To be called for all nodes
/// of level 1 before the masks of coarser levels are made (coarsen_voids).
void keep_reached(const NodeGrid& grid, const NodeAddress& node, RasterView<const double> values, RasterView<const double> decoded, VoidMask& fine);

/// The stream of a node, empty where no cell of its block is flat. `coarse` and `fine` as encode_voids wants them, `values` the stored
/// numbers of the block, none of them NaN where flat, each of the type.
std::vector<std::byte> encode_flat(const NodeGrid& grid, const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine,
                                   RasterView<const double> values, ValueType type);

/// The inverse: fills the cells of the block that lie in `fine`, and sets the flat ones of `decoded`, which has the extent of `fine`, or no
/// data where only the mask is wanted. Safe for untrusted bytes; `name` stands for the file in messages. Throws Error{damaged} where the list
/// breaks a rule.
void decode_flat(const NodeGrid& grid, const NodeAddress& node, std::span<const std::byte> bytes, const VoidMask& coarse, VoidMask& fine,
                 RasterView<double> decoded, ValueType type, const std::string& name);

}  // namespace arete
