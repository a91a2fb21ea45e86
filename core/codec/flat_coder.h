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

// Dead-flat water behind a lossy coder, exact: which cells are flat, by the mask of core/codec/void_mask_coder.h with 1 where flat, and
// which of the few values of its node each has. Bytes: core/codec/tree-format.md.

/// The most values that a node may have; more than squares of flat water fit into the largest node.
inline constexpr int most_flat_values = 65535;

/// 1 where stored numbers are dead-flat water: as find_flat_water says, of numbers that single floats hold. A cell depends on the
/// flat_reach cells around it. NaN is not water.
Raster<std::uint8_t> find_flat_cells(RasterView<const double> values);
inline constexpr std::int64_t flat_reach = 10;

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
