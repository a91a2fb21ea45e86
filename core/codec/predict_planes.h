#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/codec/node_grid.h"
#include "core/codec/predict_parameters.h"
#include "core/terrain/raster.h"

namespace arete {

/// A part of a level: `values(0, 0)` is cell (x, y) of it. `voids` is 1 where a cell is void, and empty (data null) where none is.
struct LevelView {
  RasterView<const std::int32_t> values;
  RasterView<const std::uint8_t> voids;
  std::int64_t x = 0;
  std::int64_t y = 0;
  Size level;  ///< all of the level
};

/// Cells with a margin on every side, so that filters need no border cases.
template <typename T>
class Plane {
 public:
  static constexpr int margin = 8;
  static constexpr int slack = 24;  ///< what a vector loop may touch beyond the right margin

  Plane() = default;
  Plane(int width, int height, T value)
      : stride_(width + 2 * margin + slack), cells_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height + 2 * margin + 1), value) {}
  T* row(int y) { return cells_.data() + static_cast<std::ptrdiff_t>(y + margin) * stride_ + margin; }
  const T* row(int y) const { return cells_.data() + static_cast<std::ptrdiff_t>(y + margin) * stride_ + margin; }

 private:
  int stride_ = 0;
  std::vector<T> cells_;
};

/// A node's cells of level l - 1, split by phase: cell (x, y) of phase p is cell (2x + odd_x(p), 2y + odd_y(p)) of the block.
struct NodePlanes {
  int block_width = 0;   ///< cells of level l - 1
  int block_height = 0;
  int width = 0;         ///< of each plane, without margins
  int height = 0;
  std::array<Plane<std::int32_t>, 4> values;
  std::array<Plane<std::int32_t>, 4> magnitudes;  ///< |residual| held to magnitude_limit; 0 where nothing was coded; none of the lattice
  std::array<Plane<std::uint8_t>, 4> voids;       ///< 1 where void; only where `any_void`
  bool any_void = false;
};

inline constexpr int odd_x(int phase) { return phase == 1 || phase == 2; }
inline constexpr int odd_y(int phase) { return phase == 1 || phase == 3; }
inline constexpr std::int32_t magnitude_limit = 1 << 20;

/// How many cells of a phase the block has along x, along y.
inline int coded_width(const NodePlanes& planes, int phase) { return (planes.block_width + 1 - odd_x(phase)) / 2; }
inline int coded_height(const NodePlanes& planes, int phase) { return (planes.block_height + 1 - odd_y(phase)) / 2; }

/// How far beyond the block a node looks at the lattice, in cells of level l.
inline constexpr int lattice_margin = Plane<std::int32_t>::margin;

/// The planes of a node with its lattice filled in; the other phases are 0. `cells` is the block in level l - 1, as by
/// NodeGrid::cells, `voids` its mask (1 void; data null: none); `coarse` holds at least the part of level l that is within lattice_margin of the block. Void cells of the
/// lattice are extended from the valid ones around them, and the lattice beyond the border of the level along straight lines.
NodePlanes make_planes(const LevelView& coarse, const Window& cells, RasterView<const std::uint8_t> voids, const PredictParameters& parameters);

/// Copies the block out of the planes.
void copy_block(const NodePlanes& planes, RasterView<std::int32_t> values);

}  // namespace arete
