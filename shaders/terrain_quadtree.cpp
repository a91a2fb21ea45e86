#include "shaders/terrain_quadtree.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>
#include <unordered_map>

#include "core/support/parallel.h"

namespace arete {
namespace {

/// Corners a b / c d of a quad; (s, t) is where the middle sample lies in it, 1/2 but at the border of the raster.
struct Quad {
  float a, b, c, d;
  double s, t;
};

/// What the nine samples of a quad differ from it.
double midpoint_error(const Quad& q, float north, float west, float centre, float east, float south) {
  const auto mix = [](double from, double to, double t) { return from + t * (to - from); };
  const auto off = [](double value, double plane) { return std::abs(value - plane); };
  const double falling = q.s >= q.t ? q.a + q.s * (q.b - q.a) + q.t * (q.d - q.b) : q.a + q.t * (q.c - q.a) + q.s * (q.d - q.c);
  const double rising = q.s + q.t <= 1 ? q.a + q.s * (q.b - q.a) + q.t * (q.c - q.a) : q.d + (1 - q.s) * (q.c - q.d) + (1 - q.t) * (q.b - q.d);
  return std::max({off(north, mix(q.a, q.b, q.s)), off(south, mix(q.c, q.d, q.s)), off(west, mix(q.a, q.c, q.t)), off(east, mix(q.b, q.d, q.t)),
                   off(centre, falling), off(centre, rising)});
}

/// Where the middle of [from, from + step] lies between its ends, which the last sample cuts off.
double middle_share(std::int64_t from, std::int64_t step, std::int64_t last) {
  const double length = static_cast<double>(std::min(from + step, last) - from);
  return length > 0 ? std::min(1.0, static_cast<double>(step / 2) / length) : 0;
}

/// Node of level 0 at cell (x0, y0) from its 65 x 65 samples.
QuadtreeNode measure_leaf(RasterView<const TerrainSample> samples, std::int64_t x0, std::int64_t y0, Size size) {
  QuadtreeNode node;
  node.low = node.high = samples(0, 0).height;
  for (std::int64_t y = 0; y <= node_cells; ++y)
    for (std::int64_t x = 0; x <= node_cells; ++x) {
      node.low = std::min(node.low, samples(x, y).height);
      node.high = std::max(node.high, samples(x, y).height);
      node.any_valid |= samples(x, y).valid > 0;
    }
  std::vector<float> finer(node_cells * node_cells, 0.0f), coarser;
  for (int k = 1; k < node_steps; ++k) {
    const std::int64_t step = std::int64_t{1} << k, half = step / 2, count = node_cells / step;
    coarser.assign(static_cast<std::size_t>(count * count), 0.0f);
    for (std::int64_t j = 0; j < count; ++j)
      for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t x = i * step, y = j * step;
        const auto z = [&](std::int64_t dx, std::int64_t dy) { return samples(x + dx, y + dy).height; };
        const Quad quad{z(0, 0), z(step, 0), z(0, step), z(step, step),
                        middle_share(x0 + x, step, size.width - 1), middle_share(y0 + y, step, size.height - 1)};
        const auto part = [&](std::int64_t u, std::int64_t v) { return finer[static_cast<std::size_t>((2 * j + v) * 2 * count + 2 * i + u)]; };
        const double own = midpoint_error(quad, z(half, 0), z(0, half), z(half, half), z(step, half), z(half, step));
        const float error = static_cast<float>(own) + std::max({part(0, 0), part(1, 0), part(0, 1), part(1, 1)});
        coarser[static_cast<std::size_t>(j * count + i)] = error;
        node.error[static_cast<std::size_t>(k)] = std::max(node.error[static_cast<std::size_t>(k)], error);
      }
    finer.swap(coarser);
  }
  return node;
}

std::int64_t nodes_along(std::int64_t samples, int level) {
  const std::int64_t side = std::int64_t{node_cells} << level;
  return std::max<std::int64_t>(1, (samples - 1 + side - 1) / side);
}

/// Nodes of a level from the four each that they cover; `corners` are the samples at the corners of the leaves.
Raster<QuadtreeNode> merge(const Raster<QuadtreeNode>& finer, int level, const Raster<float>& corners, Size size) {
  Raster<QuadtreeNode> nodes(nodes_along(size.width, level), nodes_along(size.height, level));
  const std::int64_t side = std::int64_t{node_cells} << level, leaves = std::int64_t{1} << level;
  for (std::int64_t y = 0; y < nodes.height(); ++y)
    for (std::int64_t x = 0; x < nodes.width(); ++x) {
      QuadtreeNode node = finer(2 * x, 2 * y);
      std::array<float, node_steps> parts = node.error;
      for (const auto& [u, v] : {std::pair{1, 0}, {0, 1}, {1, 1}}) {
        if (2 * x + u >= finer.width() || 2 * y + v >= finer.height()) continue;
        const QuadtreeNode& part = finer(2 * x + u, 2 * y + v);
        node.low = std::min(node.low, part.low);
        node.high = std::max(node.high, part.high);
        node.any_valid |= part.any_valid;
        for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = std::max(parts[i], part.error[i]);
      }
      const auto z = [&](std::int64_t i, std::int64_t j) {
        return corners(std::min((2 * x + i) * leaves / 2, corners.width() - 1), std::min((2 * y + j) * leaves / 2, corners.height() - 1));
      };
      const Quad quad{z(0, 0), z(2, 0), z(0, 2), z(2, 2), middle_share(x * side, side, size.width - 1), middle_share(y * side, side, size.height - 1)};
      for (std::size_t i = 0; i + 1 < parts.size(); ++i) node.error[i] = parts[i + 1];
      node.error.back() = parts.back() + static_cast<float>(midpoint_error(quad, z(1, 0), z(0, 1), z(1, 1), z(2, 1), z(1, 2)));
      nodes(x, y) = node;
    }
  return nodes;
}

}  // namespace

TerrainQuadtree build_quadtree(const SamplePyramid& pyramid, int threads, Progress& progress) {
  const Size size = pyramid.size(0);
  TerrainQuadtree tree{{}, size};
  Raster<QuadtreeNode> leaves(nodes_along(size.width, 0), nodes_along(size.height, 0));
  Raster<float> corners(leaves.width() + 1, leaves.height() + 1);
  progress.begin("measuring", leaves.size().cells());
  std::mutex reporting;
  parallel_for(leaves.size().cells(), threads, [&](std::int64_t i) {
    const std::int64_t x = i % leaves.width(), y = i / leaves.width();
    Raster<TerrainSample> samples(node_cells + 1, node_cells + 1);
    pyramid.read(0, {x * node_cells, y * node_cells, node_cells + 1, node_cells + 1}, samples.view());
    leaves(x, y) = measure_leaf(samples.view(), x * node_cells, y * node_cells, size);
    corners(x, y) = samples(0, 0).height;
    if (x + 1 == leaves.width()) corners(x + 1, y) = samples(node_cells, 0).height;
    if (y + 1 == leaves.height()) corners(x, y + 1) = samples(0, node_cells).height;
    if (x + 1 == leaves.width() && y + 1 == leaves.height()) corners(x + 1, y + 1) = samples(node_cells, node_cells).height;
    const std::lock_guard lock(reporting);
    progress.advance(1);
  });
  progress.end();
  tree.levels.push_back(std::move(leaves));
  while (tree.levels.back().size().cells() > 1)
    tree.levels.push_back(merge(tree.levels.back(), static_cast<int>(tree.levels.size()), corners, size));
  return tree;
}

namespace {

struct NodeId {
  int level;
  std::int64_t x, y;
  bool operator==(const NodeId&) const = default;
};
struct NodeHash {
  std::size_t operator()(const NodeId& id) const {
    return static_cast<std::size_t>((static_cast<std::uint64_t>(id.level) << 58) ^ (static_cast<std::uint64_t>(id.y) << 29) ^ static_cast<std::uint64_t>(id.x));
  }
};

struct Leaf {
  bool seen = false;
  int spacing = 0;  // log2 of the distance of vertices that it wants, level..level + 6
};
using Leaves = std::unordered_map<NodeId, Leaf, NodeHash>;

constexpr std::array<std::array<int, 2>, 4> towards = {{{-1, 0}, {0, -1}, {1, 0}, {0, 1}}};  // west, north, east, south

class Selection {
 public:
  Selection(const TerrainQuadtree& tree, const TerrainPlacement& placement, const Camera& camera, Size picture, const SelectionOptions& options)
      : tree_(tree), placement_(placement), camera_(camera), options_(options) {
    const double half = std::tan(camera.field_of_view_deg * M_PI / 360), aspect = static_cast<double>(picture.width) / static_cast<double>(picture.height);
    // Pixels per radian grow towards the corners of the picture.
    scale_ = static_cast<double>(picture.height) / (2 * half) * std::sqrt(1 + half * half * (1 + aspect * aspect));
    view_ = projection_matrix(camera, picture, {0, 0, picture.width, picture.height}, 1);
    grow({static_cast<int>(tree.levels.size()) - 1, 0, 0});
    balance();
  }

  std::vector<TerrainPatch> patches() const {
    std::vector<TerrainPatch> all;
    for (const auto& [id, leaf] : leaves_)
      if (leaf.seen && node(id).any_valid) add_patches(id, leaf, all);
    if (placement_.floor) {
      TerrainPatch floor;
      floor.level = static_cast<std::int32_t>(tree_.levels.size()) - 1;
      floor.side = 5;
      all.push_back(floor);
    }
    std::sort(all.begin(), all.end(), [](const TerrainPatch& a, const TerrainPatch& b) {
      return std::tie(a.level, a.y, a.x, a.side) < std::tie(b.level, b.y, b.x, b.side);
    });
    return all;
  }

 private:
  const QuadtreeNode& node(const NodeId& id) const { return tree_.levels[static_cast<std::size_t>(id.level)](id.x, id.y); }
  bool exists(const NodeId& id) const {
    const Raster<QuadtreeNode>& nodes = tree_.levels[static_cast<std::size_t>(id.level)];
    return id.x >= 0 && id.y >= 0 && id.x < nodes.width() && id.y < nodes.height();
  }
  Box box(const NodeId& id) const {
    TerrainPatch patch;
    patch.x = static_cast<std::int32_t>(id.x * node_cells << id.level);
    patch.y = static_cast<std::int32_t>(id.y * node_cells << id.level);
    patch.level = id.level;
    return patch_box(tree_, placement_, patch);
  }
  /// Pixels that a metre covers at most anywhere in the box.
  double pixels_per_metre(const Box& where) const {
    double squares = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double off = std::max({0.0, where.low[c] - camera_.eye[c], camera_.eye[c] - where.high[c]});
      squares += off * off;
    }
    return scale_ / std::max(std::sqrt(squares), 1e-9);
  }

  void grow(const NodeId& id) {
    const Box where = box(id);
    const bool seen = sees(view_, camera_, where);
    const double pixels = pixels_per_metre(where), step = static_cast<double>(std::int64_t{1} << id.level);
    const double metres = std::max(placement_.cell.x_m, placement_.cell.y_m) * step;
    const QuadtreeNode& own = node(id);
    const auto fits = [&](float error) { return error * placement_.exaggeration * pixels <= options_.max_error_px; };
    if (id.level > 0 && seen && (metres * pixels > options_.max_sample_px || !fits(own.error[0]))) {
      for_children(id, [&](const NodeId& child) { grow(child); });
      return;
    }
    Leaf leaf{seen, id.level};
    if (seen)
      for (std::size_t i = 1; i < own.error.size() && fits(own.error[i]); ++i) leaf.spacing = id.level + static_cast<int>(i);
    leaves_[id] = leaf;
  }

  template <typename Visit>
  void for_children(const NodeId& id, const Visit& visit) const {
    for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
      const NodeId child{id.level - 1, 2 * id.x + u, 2 * id.y + v};
      if (exists(child)) visit(child);
    }
  }

  /// The leaf of that level or coarser that covers a node, if any.
  const NodeId* covering(NodeId id) {
    for (; id.level < static_cast<int>(tree_.levels.size()); ++id.level, id.x /= 2, id.y /= 2)
      if (const auto found = leaves_.find(id); found != leaves_.end()) return &found->first;
    return nullptr;
  }

  void balance() {
    std::vector<NodeId> waiting;
    for (const auto& [id, leaf] : leaves_) waiting.push_back(id);
    while (!waiting.empty()) {
      const NodeId id = waiting.back();
      waiting.pop_back();
      if (!leaves_.count(id)) continue;
      for (const auto& [dx, dy] : towards) {
        const NodeId beside{id.level, id.x + dx, id.y + dy};
        if (!exists(beside)) continue;
        const NodeId* large = covering(beside);
        if (large == nullptr || large->level <= id.level + 1) continue;
        const NodeId split = *large;
        const Leaf parent = leaves_.at(split);
        leaves_.erase(split);
        for_children(split, [&](const NodeId& child) {
          // What did for the whole does for a part, as far as it has that few segments.
          leaves_[child] = {parent.seen && sees(view_, camera_, box(child)), std::min(parent.spacing, child.level + node_steps - 1)};
          waiting.push_back(child);
        });
        waiting.push_back(id);
      }
    }
  }

  /// Spacing that both sides of an edge use.
  int edge_spacing(const NodeId& id, const Leaf& leaf, std::size_t side) const {
    const auto [dx, dy] = towards[side];
    const NodeId beside{id.level, id.x + dx, id.y + dy};
    if (!exists(beside)) return leaf.spacing;
    if (const auto same = leaves_.find(beside); same != leaves_.end()) return std::min(leaf.spacing, same->second.spacing);
    const NodeId above{id.level + 1, beside.x / 2, beside.y / 2};
    if (const auto large = leaves_.find(above); large != leaves_.end()) return long_edge_spacing(above, large->second, (side + 2) % 4);
    return long_edge_spacing(id, leaf, side);
  }

  /// The edge of a leaf with two of the next finer level on the other side.
  int long_edge_spacing(const NodeId& id, const Leaf& leaf, std::size_t side) const {
    const auto [dx, dy] = towards[side];
    const NodeId beside{id.level, id.x + dx, id.y + dy};
    int spacing = leaf.spacing;
    for (std::int64_t half = 0; half < 2; ++half) {
      const NodeId small{id.level - 1, 2 * beside.x + (dx == 0 ? half : dx < 0 ? 1 : 0), 2 * beside.y + (dy == 0 ? half : dy < 0 ? 1 : 0)};
      if (const auto found = leaves_.find(small); found != leaves_.end()) spacing = std::min(spacing, found->second.spacing);
    }
    return std::max(spacing, id.level);
  }

  void add_patches(const NodeId& id, const Leaf& leaf, std::vector<TerrainPatch>& all) const {
    TerrainPatch ground;
    ground.x = static_cast<std::int32_t>(id.x * node_cells << id.level);
    ground.y = static_cast<std::int32_t>(id.y * node_cells << id.level);
    ground.level = id.level;
    for (std::size_t side = 0; side < 4; ++side) ground.outer[side] = node_cells >> (edge_spacing(id, leaf, side) - id.level);
    ground.inner = {node_cells >> (leaf.spacing - id.level), node_cells >> (leaf.spacing - id.level)};
    all.push_back(ground);
    if (!placement_.walls) return;
    for (std::size_t side = 0; side < 4; ++side) {
      if (exists({id.level, id.x + towards[side][0], id.y + towards[side][1]})) continue;
      TerrainPatch wall = ground;
      wall.outer = {1, ground.outer[side], 1, ground.outer[side]};
      wall.inner = {ground.outer[side], 1};
      wall.side = static_cast<std::int32_t>(side) + 1;
      all.push_back(wall);
    }
  }

  const TerrainQuadtree& tree_;
  const TerrainPlacement& placement_;
  const Camera& camera_;
  const SelectionOptions& options_;
  double scale_ = 1;
  std::array<double, 16> view_{};
  Leaves leaves_;
};

}  // namespace

std::vector<TerrainPatch> select_patches(const TerrainQuadtree& tree, const TerrainPlacement& placement, const Camera& camera, Size picture,
                                         const SelectionOptions& options) {
  return Selection(tree, placement, camera, picture, options).patches();
}

Box patch_box(const TerrainQuadtree& tree, const TerrainPlacement& placement, const TerrainPatch& patch) {
  const std::int64_t side = std::int64_t{node_cells} << patch.level;
  const QuadtreeNode& node = tree.levels[static_cast<std::size_t>(patch.level)](patch.x / side, patch.y / side);
  const double west = patch.x * placement.cell.x_m, north = -patch.y * placement.cell.y_m;
  const double east = static_cast<double>(std::min(patch.x + side, tree.size.width - 1)) * placement.cell.x_m;
  const double south = -static_cast<double>(std::min(patch.y + side, tree.size.height - 1)) * placement.cell.y_m;
  const double low = node.low * placement.exaggeration;
  return {{west, south, placement.walls || placement.floor ? std::min(low, placement.base) : low}, {east, north, node.high * placement.exaggeration}};
}

std::int64_t count_triangles(const TerrainPatch& patch) {
  const std::int64_t around = patch.outer[0] + patch.outer[1] + patch.outer[2] + patch.outer[3];
  if (around == 4 && patch.inner[0] == 1 && patch.inner[1] == 1) return 2;
  // A level of 1 inside is taken as 2 when any other is more.
  const std::int64_t a = std::max(2, patch.inner[0]) - 2, b = std::max(2, patch.inner[1]) - 2;
  return 2 * a * b + around + 2 * a + 2 * b;
}

}  // namespace arete
