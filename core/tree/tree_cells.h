#pragma once

#include <cstdint>
#include <vector>

#include "core/codec/tree_file.h"
#include "core/codec/void_mask_coder.h"
#include "core/tree/measure.h"

namespace arete {

/// A raster as the coders of the tree see it.
struct TreeCells {
  Raster<double> stored;  ///< NaN where void
  VoidMask voids;
  bool any_void = false;
  std::int64_t valid = 0;
  double lowest = 0, highest = 0;  ///< stored, of the valid cells
  double metres_per_stored = 1;
};

/// Throws Error{input} where all cells are void.
TreeCells read_tree_cells(const StoredSource& source, const TreeHeader& header);

/// The cells as single floats, voids filled with the smoothest surface: what coders that need a number everywhere are given.
Raster<float> fill_cells(const TreeCells& cells);

/// The streams of the mask of a raster with voids, by NodeGrid::index, and of the coarsest level; both empty where none is void.
struct MaskStreams {
  std::vector<std::vector<std::byte>> nodes;
  std::vector<std::byte> root;
};
MaskStreams encode_masks(const TreeCells& cells, const NodeGrid& grid, int threads);

/// The file of a tree in memory. `header` lacks only what the arguments say.
std::vector<std::byte> write_tree(TreeHeader header, const MaskStreams& masks, const std::vector<std::byte>& root,
                                  const std::vector<std::vector<std::byte>>& nodes);

/// What a reader of the file will find, against the original.
TreeErrors measure_file(const TreeCells& cells, const std::vector<std::byte>& file, int threads);

}  // namespace arete
