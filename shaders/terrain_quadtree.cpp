#include "shaders/terrain_quadtree.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>
#include <unordered_map>

#include "core/support/parallel.h"

namespace arete {
namespace {

/// Errors in steps of 2^(1/8): 0 is none, 1 is 2^-13 m.
constexpr int error_codes = 256;
const std::array<float, error_codes>& error_table() {
  static const std::array<float, error_codes> table = [] {
    std::array<float, error_codes> metres{};
    for (int i = 1; i < error_codes; ++i) metres[static_cast<std::size_t>(i)] = static_cast<float>(std::exp2((i - 1) / 8.0 - 13));
    return metres;
  }();
  return table;
}

/// Rounded up.
std::uint8_t error_code(double metres) {
  const auto& table = error_table();
  const auto found = std::lower_bound(table.begin(), table.end(), metres);
  return static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(found - table.begin(), error_codes - 1));
}

/// Height of a sample of the DEM; where it is void, of what is drawn at the edge of the hole.
struct Height {
  float metres;
  bool valid;
};

/// Samples of a level from (x, y) on; those beyond the raster are its last ones.
class SampleGrid {
 public:
  SampleGrid(RasterView<const Height> heights, std::int64_t x, std::int64_t y, int step) : heights_(heights), x_(x), y_(y), step_(step) {}
  const Height& operator()(std::int64_t i, std::int64_t j) const {
    return heights_(std::min(x_ + i * step_, heights_.width - 1), std::min(y_ + j * step_, heights_.height - 1));
  }

 private:
  RasterView<const Height> heights_;
  std::int64_t x_, y_;
  int step_;
};

/// Where samples 0..count lie between the corners of a quad, which the last sample of the raster cuts off.
struct Places {
  std::array<double, node_cells + 1> share;
  int count = 0;  // beyond it there is nothing

  Places(std::int64_t from, std::int64_t step, int segments, std::int64_t last) {
    const std::int64_t length = std::min(from + step * segments, last) - from;
    for (; count <= segments; ++count) {
      const std::int64_t at = std::min(step * count, length);
      share[static_cast<std::size_t>(count)] = length > 0 ? static_cast<double>(at) / static_cast<double>(length) : 0;
      if (at == length) break;
    }
  }
};

/// What valid samples differ from one quad over them, cut along either diagonal. Its corners are samples 0 and `segments`.
double quad_error(const SampleGrid& samples, int segments, const Places& across, const Places& down) {
  const double a = samples(0, 0).metres, b = samples(segments, 0).metres, c = samples(0, segments).metres, d = samples(segments, segments).metres;
  double worst = 0;
  for (int j = 0; j <= down.count; ++j)
    for (int i = 0; i <= across.count; ++i) {
      const Height& height = samples(i, j);
      if (!height.valid) continue;
      const double s = across.share[static_cast<std::size_t>(i)], t = down.share[static_cast<std::size_t>(j)], z = height.metres;
      const double falling = s >= t ? a + s * (b - a) + t * (d - b) : a + t * (c - a) + s * (d - c);
      const double rising = s + t <= 1 ? a + s * (b - a) + t * (c - a) : d + (1 - s) * (c - d) + (1 - t) * (b - d);
      worst = std::max({worst, std::abs(z - falling), std::abs(z - rising)});
    }
  return worst;
}

std::int64_t nodes_along(std::int64_t samples, int level) {
  const std::int64_t side = std::int64_t{node_cells} << level;
  return std::max<std::int64_t>(1, (samples - 1 + side - 1) / side);
}

/// Node of level 0 at sample (x0, y0) of the DEM, (x, y) of `heights`.
QuadtreeNode measure_leaf(RasterView<const Height> heights, std::int64_t x, std::int64_t y, std::int64_t x0, std::int64_t y0, Size size) {
  QuadtreeNode node;
  node.low = node.high = heights(x, y).metres;
  for (std::int64_t j = y; j <= std::min(y + node_cells, heights.height - 1); ++j)
    for (std::int64_t i = x; i <= std::min(x + node_cells, heights.width - 1); ++i) {
      node.low = std::min(node.low, heights(i, j).metres);
      node.high = std::max(node.high, heights(i, j).metres);
      node.any_valid |= heights(i, j).valid;
    }
  for (int k = 1; k < node_steps; ++k) {
    const int step = 1 << k;
    double worst = 0;
    for (int v = 0; v < node_cells && y0 + v < size.height - 1; v += step)
      for (int u = 0; u < node_cells && x0 + u < size.width - 1; u += step)
        worst = std::max(worst, quad_error(SampleGrid(heights, x + u, y + v, 1), step, Places(x0 + u, 1, step, size.width - 1), Places(y0 + v, 1, step, size.height - 1)));
    node.error[static_cast<std::size_t>(k)] = std::max(error_code(worst), node.error[static_cast<std::size_t>(k - 1)]);
  }
  return node;
}

/// Node (x, y) of a level above 0 from those that it covers, and its 17 x 17 samples.
QuadtreeNode merge(const Raster<QuadtreeNode>& finer, int level, std::int64_t x, std::int64_t y, const SampleGrid& samples, Size size) {
  QuadtreeNode node = finer(2 * x, 2 * y);
  std::array<std::uint8_t, node_steps> parts = node.error;
  for (const auto& [u, v] : {std::pair{1, 0}, {0, 1}, {1, 1}}) {
    if (2 * x + u >= finer.width() || 2 * y + v >= finer.height()) continue;
    const QuadtreeNode& part = finer(2 * x + u, 2 * y + v);
    node.low = std::min(node.low, part.low);
    node.high = std::max(node.high, part.high);
    node.any_valid |= part.any_valid;
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = std::max(parts[i], part.error[i]);
  }
  std::copy(parts.begin() + 1, parts.end(), node.error.begin());
  const std::int64_t step = std::int64_t{1} << level, side = node_cells * step;
  const double plane = quad_error(samples, node_cells, Places(x * side, step, node_cells, size.width - 1), Places(y * side, step, node_cells, size.height - 1));
  node.error.back() = std::max(parts.back(), error_code(plane + error_m(node, 0)));
  return node;
}

/// Cells aside of the blocks that are read, and the levels whose nodes fit in one.
constexpr int block_levels = 7;
constexpr std::int64_t block_cells = std::int64_t{node_cells} << (block_levels - 1);
/// Every so many cells a sample is kept for the levels above.
constexpr std::int64_t kept_step = std::int64_t{1} << block_levels;

/// Of the samples of the pyramid's base, as if they were all.
std::vector<Raster<QuadtreeNode>> measure(const SamplePyramid& pyramid, int threads, Progress& progress) {
  const Size size = pyramid.size(pyramid.base());
  std::vector<Raster<QuadtreeNode>> levels;
  do {
    const int level = static_cast<int>(levels.size());
    levels.emplace_back(nodes_along(size.width, level), nodes_along(size.height, level));
  } while (levels.back().size().cells() > 1);
  const int count = static_cast<int>(levels.size());
  const auto kept_along = [](std::int64_t samples) { return (samples - 1 + kept_step - 1) / kept_step + 1; };
  Raster<Height> kept(kept_along(size.width), kept_along(size.height));
  const std::int64_t across = (size.width - 2) / block_cells + 1, down = (size.height - 2) / block_cells + 1;
  progress.begin("measuring", across * down);
  std::mutex reporting;
  parallel_for(across * down, threads, [&](std::int64_t block) {
    const std::int64_t x0 = block % across * block_cells, y0 = block / across * block_cells;
    const Size cells{std::min(block_cells + 1, size.width - x0), std::min(block_cells + 1, size.height - y0)};
    Raster<Height> heights(cells.width, cells.height);
    constexpr std::int64_t rows = 64;
    Raster<TerrainSample> samples(cells.width, rows);
    for (std::int64_t from = 0; from < cells.height; from += rows) {
      const Window window{0, 0, cells.width, std::min(rows, cells.height - from)};
      pyramid.read(pyramid.base(), {x0, y0 + from, window.width, window.height}, samples.view().sub(window));
      for (std::int64_t y = 0; y < window.height; ++y)
        for (std::int64_t x = 0; x < window.width; ++x) heights(x, from + y) = {samples(x, y).height, samples(x, y).valid > 0};
    }
    for (std::int64_t y = 0; y < cells.height; ++y)
      for (std::int64_t x = 0; x < cells.width; ++x) {
        const auto holds = [](std::int64_t at, std::int64_t last) { return at % kept_step == 0 || at == last; };
        const auto place = [](std::int64_t at) { return (at + kept_step - 1) / kept_step; };
        // Samples that two blocks share are kept by the one that they begin.
        const bool own = (x < block_cells || x0 + x == size.width - 1) && (y < block_cells || y0 + y == size.height - 1);
        if (own && holds(x0 + x, size.width - 1) && holds(y0 + y, size.height - 1)) kept(place(x0 + x), place(y0 + y)) = heights(x, y);
      }
    for (int level = 0; level < std::min(count, block_levels); ++level) {
      Raster<QuadtreeNode>& nodes = levels[static_cast<std::size_t>(level)];
      const std::int64_t side = std::int64_t{node_cells} << level;
      for (std::int64_t y = y0 / side; y < std::min(nodes.height(), (y0 + block_cells) / side); ++y)
        for (std::int64_t x = x0 / side; x < std::min(nodes.width(), (x0 + block_cells) / side); ++x) {
          const std::int64_t u = x * side - x0, v = y * side - y0;
          nodes(x, y) = level == 0 ? measure_leaf(heights.view(), u, v, x * side, y * side, size)
                                   : merge(levels[static_cast<std::size_t>(level) - 1], level, x, y, SampleGrid(heights.view(), u, v, 1 << level), size);
        }
    }
    const std::lock_guard lock(reporting);
    progress.advance(1);
  });
  progress.end();
  for (int level = block_levels; level < count; ++level) {
    Raster<QuadtreeNode>& nodes = levels[static_cast<std::size_t>(level)];
    const int step = 1 << (level - block_levels);
    for (std::int64_t y = 0; y < nodes.height(); ++y)
      for (std::int64_t x = 0; x < nodes.width(); ++x)
        nodes(x, y) = merge(levels[static_cast<std::size_t>(level) - 1], level, x, y,
                            SampleGrid(kept.view(), x * node_cells * step, y * node_cells * step, step), size);
  }
  return levels;
}

}  // namespace

double error_m(const QuadtreeNode& node, int step) { return error_table()[node.error[static_cast<std::size_t>(step)]]; }

Size nodes_of(const TerrainQuadtree& tree, int level) { return {nodes_along(tree.size.width, level), nodes_along(tree.size.height, level)}; }

QuadtreeNode node_at(const TerrainQuadtree& tree, int level, std::int64_t x, std::int64_t y) {
  const int above = std::max(0, tree.base - level);
  QuadtreeNode node = tree.levels[static_cast<std::size_t>(level + above)](x >> above, y >> above);
  if (above == 0) return node;
  const float more = static_cast<float>(error_m(node, 1));
  node.low -= more;
  node.high += more;
  constexpr int codes_per_level = 4;  // 2^(-4/8)
  const auto measured = node.error;
  for (int i = 0; i < node_steps; ++i) {
    const int step = i - above;  // of the ancestor
    node.error[static_cast<std::size_t>(i)] = step >= 1 ? measured[static_cast<std::size_t>(step)]
                                                        : static_cast<std::uint8_t>(std::max(0, measured[1] - codes_per_level * (1 - step)));
  }
  return node;
}

TerrainQuadtree build_quadtree(const SamplePyramid& pyramid, int threads, Progress& progress) {
  TerrainQuadtree tree{{}, pyramid.size(0), pyramid.base()};
  tree.levels.resize(static_cast<std::size_t>(pyramid.base()));
  for (Raster<QuadtreeNode>& level : measure(pyramid, threads, progress)) tree.levels.push_back(std::move(level));
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
  int spacing = 0;  // log2 of the distance of vertices that it wants, level..level + 4
};
using Leaves = std::unordered_map<NodeId, Leaf, NodeHash>;

// West, north, east, south; north-west, north-east, south-east, south-west.
constexpr std::array<std::array<int, 2>, 8> towards = {{{-1, 0}, {0, -1}, {1, 0}, {0, 1}, {-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

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
  QuadtreeNode node(const NodeId& id) const { return node_at(tree_, id.level, id.x, id.y); }
  bool exists(const NodeId& id) const {
    const Size nodes = nodes_of(tree_, id.level);
    return id.x >= 0 && id.y >= 0 && id.x < nodes.width && id.y < nodes.height;
  }
  Box box(const NodeId& id) const {
    TerrainPatch patch;
    patch.x = static_cast<std::int32_t>(id.x * node_cells << id.level);
    patch.y = static_cast<std::int32_t>(id.y * node_cells << id.level);
    patch.level = id.level;
    return patch_box(tree_, placement_, patch);
  }
  /// Pixels that a metre covers at most anywhere in the box: across the view, and upright.
  std::array<double, 2> pixels_per_metre(const Box& where) const {
    std::array<double, 3> near{}, far{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double below = where.low[c] - camera_.eye[c], above = camera_.eye[c] - where.high[c];
      near[c] = std::max({0.0, below, above});
      far[c] = std::max(std::abs(below), std::abs(above));
    }
    const double across = scale_ / std::max(std::hypot(near[0], near[1], near[2]), 1e-9), level = std::hypot(far[0], far[1]);
    // Heights are seen at the sine of the angle between the view and the vertical.
    return {across, across * level / std::max(std::hypot(level, near[2]), 1e-9)};
  }

  void grow(const NodeId& id) {
    const Box where = box(id);
    const bool seen = sees(view_, camera_, where);
    const auto [across, upright] = pixels_per_metre(where);
    const double step = static_cast<double>(std::int64_t{1} << id.level);
    const double metres = std::max(placement_.cell.x_m, placement_.cell.y_m) * step;
    const QuadtreeNode own = node(id);
    const double exaggerated = upright * placement_.exaggeration;
    const auto fits = [&](int i) { return error_m(own, i) * exaggerated <= options_.max_error_px; };
    if (id.level > 0 && seen && (metres * across > options_.max_sample_px || !fits(0))) {
      for_children(id, [&](const NodeId& child) { grow(child); });
      return;
    }
    Leaf leaf{seen, id.level};
    if (seen)
      for (int i = 1; i < node_steps && fits(i); ++i) leaf.spacing = id.level + i;
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

  /// As TerrainPatch::from_above.
  int coarser_neighbours(const NodeId& id) const {
    int bits = 0;
    for (std::size_t i = 0; i < towards.size(); ++i) {
      const NodeId beside{id.level, id.x + towards[i][0], id.y + towards[i][1]};
      if (exists(beside) && leaves_.count({id.level + 1, beside.x / 2, beside.y / 2})) bits |= 1 << i;
    }
    // A side has its corners.
    constexpr std::array<std::array<int, 2>, 4> corners = {{{4, 7}, {4, 5}, {5, 6}, {6, 7}}};
    for (std::size_t side = 0; side < 4; ++side)
      if (bits >> side & 1) bits |= 1 << corners[side][0] | 1 << corners[side][1];
    return bits;
  }

  void add_patches(const NodeId& id, const Leaf& leaf, std::vector<TerrainPatch>& all) const {
    TerrainPatch ground;
    ground.x = static_cast<std::int32_t>(id.x * node_cells << id.level);
    ground.y = static_cast<std::int32_t>(id.y * node_cells << id.level);
    ground.level = id.level;
    for (std::size_t side = 0; side < 4; ++side) ground.outer[side] = node_cells >> (edge_spacing(id, leaf, side) - id.level);
    ground.inner = {node_cells >> (leaf.spacing - id.level), node_cells >> (leaf.spacing - id.level)};
    if (id.level < tree_.base) ground.from_above = coarser_neighbours(id);
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
  const QuadtreeNode node = node_at(tree, patch.level, patch.x / side, patch.y / side);
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
