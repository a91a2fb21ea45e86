#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/codec/node_grid.h"
#include "core/terrain/raster.h"

namespace arete {

// Which cells of a tree are void. A cell of level l is void where the cell of level l - 1 that it lies over is; a node says it
// of the other three quarters of its cells, each bit predicted from the coarse cells around and from what the node has said.

/// Cells of a level, 1 where void: all of it, or a part from (x, y) on.
struct VoidMask {
  Raster<std::uint8_t> cells;
  std::int64_t x = 0;
  std::int64_t y = 0;
};

/// The mask of level + 1, from all of `level`.
VoidMask coarsen_voids(const VoidMask& fine);

/// The stream of a node: empty where no cell of its block is void. `coarse` holds the cells of the node's level that are
/// within one cell of its block, `fine` the cells of the block and maybe others.
std::vector<std::byte> encode_voids(const NodeGrid& grid, const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine);

/// The inverse: fills the cells of the block that lie in `fine`, which holds those on the coarse grid as well afterwards. Safe
/// for untrusted bytes: any bytes give some mask.
void decode_voids(const NodeGrid& grid, const NodeAddress& node, std::span<const std::byte> bytes, const VoidMask& coarse, VoidMask& fine);

/// The mask of the coarsest level, a bit a cell, the first in the lowest bit; and back. Throws Error{damaged}.
std::vector<std::byte> encode_root_voids(const VoidMask& root);
VoidMask decode_root_voids(std::span<const std::byte> bytes, const Size& size, const std::string& name);

}  // namespace arete
