#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

// The tree of a raster. Level 0 is the raster; level l has half the cells of level l - 1 along each axis, rounded up, its
// cell (x, y) over cell (2x, 2y). A node of level l >= 1 refines level l to level l - 1 over a square of `side` cells of level
// l - 1, and has up to four children, of level l - 1, over its quarters. The root is level `levels` itself.

struct NodeAddress {
  int level = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
};

class NodeGrid {
 public:
  static constexpr int root_side = 8;  ///< the coarsest level has at most so many cells along each axis
  static constexpr int least_side = 32;
  static constexpr int greatest_side = 1024;

  NodeGrid() = default;
  /// `side`: a power of two from least_side to greatest_side. The size is at least 1 x 1.
  NodeGrid(const Size& size, int side) : size_(size), side_(side) {
    while (level_size(levels_).width > root_side || level_size(levels_).height > root_side) ++levels_;
  }
  const Size& size() const { return size_; }
  int side() const { return side_; }
  int levels() const { return levels_; }
  Size level_size(int level) const { return {shrink(size_.width, level), shrink(size_.height, level)}; }

  /// Nodes of a level, 1 to levels().
  Size nodes(int level) const {
    const Size fine = level_size(level - 1);
    return {(fine.width + side_ - 1) / side_, (fine.height + side_ - 1) / side_};
  }
  /// The cells of level - 1 that a node is over.
  Window cells(const NodeAddress& node) const {
    const Size fine = level_size(node.level - 1);
    const std::int64_t x = node.x * side_, y = node.y * side_;
    return {x, y, std::min<std::int64_t>(side_, fine.width - x), std::min<std::int64_t>(side_, fine.height - y)};
  }
  std::int64_t node_count() const { return levels_ == 0 ? 0 : first_of(1) + nodes(1).cells(); }
  /// Nodes are numbered from the coarsest level to the finest, row by row.
  std::int64_t index(const NodeAddress& node) const { return first_of(node.level) + node.y * nodes(node.level).width + node.x; }
  NodeAddress address(std::int64_t index) const {
    int level = levels_;
    for (; index >= nodes(level).cells(); --level) index -= nodes(level).cells();
    return {level, index % nodes(level).width, index / nodes(level).width};
  }

 private:
  static std::int64_t shrink(std::int64_t n, int level) { return ((n - 1) >> level) + 1; }
  std::int64_t first_of(int level) const {
    std::int64_t first = 0;
    for (int l = levels_; l > level; --l) first += nodes(l).cells();
    return first;
  }
  Size size_{1, 1};
  int side_ = least_side;
  int levels_ = 0;
};

/// The stream of a node by its index. Called from several threads.
using StreamReader = std::function<std::vector<std::byte>(std::int64_t index)>;

/// Where an encoder puts the streams of nodes: each once, in the order of their indexes, and may read back what it has put.
struct NodeStore {
  std::function<void(std::vector<std::byte> stream)> add;  ///< called from one thread
  StreamReader read;
};

}  // namespace arete
