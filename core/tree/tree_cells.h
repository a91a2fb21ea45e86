#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/codec/predictive_encoder.h"
#include "core/codec/tree_file.h"
#include "core/codec/value_map.h"
#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "core/terrain/cell_store.h"
#include "core/terrain/raster_io.h"
#include "core/tree/measure.h"

namespace arete {

/// A raster as the coders of the tree see it: its stored numbers by window, and what a first pass over them has found.
struct TreeCells {
  std::shared_ptr<const StoredSource> stored;  ///< in memory where the raster fits into a quarter of what is given, else the source itself
  bool any_void = false;
  std::int64_t valid = 0;
  StoredRange range;  ///< stored, of the valid cells
  double metres_per_stored = 1;
  Size size() const { return stored->size(); }
};

/// `source` must outlive the result. Throws Error{input} where all cells are void.
TreeCells read_tree_cells(const StoredSource& source, const TreeHeader& header, const Scratch& scratch, Progress* progress = nullptr);

/// Gives all numbers of a raster away, part by part.
void visit_cells(const StoredSource& source, const std::function<void(const Window&, const Raster<double>&)>& visit);

/// Stored numbers of a window of a level: of every 2^level-th cell.
Raster<double> read_level(const StoredSource& source, int level, const Window& window);

/// The cells as single floats, voids filled with the smoothest surface: for coders that need a number everywhere. Rasters beyond
/// 2048 cells along an axis are filled in tiles that look 128 cells beyond their borders. Safe to call from several threads.
class FilledCells final : public RasterSource {
 public:
  /// `cells` must outlive it. Keeps 4 bytes a cell where there are voids, as `scratch` says.
  FilledCells(const TreeCells& cells, const Scratch& scratch, int threads);
  Size size() const override { return cells_.size(); }
  void read(const Window& window, RasterView<float> out) const override;

 private:
  const TreeCells& cells_;
  CellStore<float> fills_;  ///< read at voids only; empty where there are none
};

/// The cells as the numbers of a map.
class MappedCells final : public NumberSource {
 public:
  MappedCells(const TreeCells& cells, const ValueMap& map) : cells_(cells), map_(map) {}
  Size size() const override { return cells_.size(); }
  bool any_void() const override { return cells_.any_void; }
  void read(const Window& window, RasterView<std::int32_t> values, RasterView<std::uint8_t> voids) const override;

 private:
  const TreeCells& cells_;
  ValueMap map_;
};

/// Streams of a mask by NodeGrid::index, and of the coarsest level; both empty where there is none.
struct MaskStreams {
  std::vector<std::vector<std::byte>> nodes;
  std::vector<std::byte> root;
  bool any() const { return !root.empty(); }
  std::size_t bytes() const;
};

/// Of the voids.
MaskStreams encode_masks(const TreeCells& cells, const NodeGrid& grid, const Scratch& scratch, int threads);

/// Of dead-flat water, with its values (core/codec/flat_coder.h); none where less than `least_share` of the valid cells is water.
MaskStreams encode_flat_water(const TreeCells& cells, ValueType type, const NodeGrid& grid, double least_share, const Scratch& scratch, int threads);

}  // namespace arete
