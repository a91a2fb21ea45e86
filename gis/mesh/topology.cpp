#include "gis/mesh/topology.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "core/support/error.h"
#include "gis/mesh/mesh_blocks.h"

namespace arete {
namespace {

constexpr std::int64_t most_ranges = 4096;

bool has_edges(const MeshTriangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

void check_indices(const MeshTriangle& triangle, std::int64_t index, std::int64_t vertices) {
  for (const std::int64_t vertex : triangle)
    if (vertex < 0 || vertex >= vertices)
      throw Error(ErrorKind::input, "triangle " + std::to_string(index) + " of the mesh names vertex " + std::to_string(vertex) + ", but there are only " +
                                        std::to_string(vertices));
}

/// Vertices that are joined know the same root.
class Joined {
 public:
  explicit Joined(std::int64_t vertices) : parent_(static_cast<std::size_t>(vertices)) { std::iota(parent_.begin(), parent_.end(), 0u); }
  void join(std::int64_t a, std::int64_t b) {
    std::uint32_t low = root(static_cast<std::uint32_t>(a)), high = root(static_cast<std::uint32_t>(b));
    if (low > high) std::swap(low, high);
    parent_[high] = low;
  }
  std::int64_t parts(const std::vector<bool>& used) const {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) count += used[i] && parent_[i] == i;
    return count;
  }

 private:
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::uint32_t> parent_;
};

/// Ranges of vertices; an edge belongs to that of its lower vertex.
struct Ranges {
  std::int64_t width = 1;  // vertices in a range
  std::vector<std::int64_t> edges;
};

/// Looks at every triangle once: indices, parts, vertices without triangle, and how many edges each range of vertices has.
Ranges survey(const MeshSource& mesh, std::int64_t memory_bytes, Progress& progress, MeshTopology& topology) {
  const std::int64_t vertices = mesh.vertices();
  Ranges ranges;
  ranges.width = std::max<std::int64_t>(1, (vertices + most_ranges - 1) / most_ranges);
  ranges.edges.assign(most_ranges, 0);
  std::vector<bool> used(static_cast<std::size_t>(vertices));
  std::optional<Joined> joined;
  if (vertices <= std::numeric_limits<std::uint32_t>::max() && vertices * 4 <= memory_bytes / 2) joined.emplace(vertices);
  for_triangle_blocks(mesh, [&](std::int64_t first, std::span<const MeshTriangle> triangles) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const MeshTriangle& t = triangles[i];
      check_indices(t, first + static_cast<std::int64_t>(i), vertices);
      for (const std::int64_t vertex : t) used[static_cast<std::size_t>(vertex)] = true;
      if (joined) joined->join(t[0], t[1]), joined->join(t[1], t[2]);
      if (!has_edges(t)) continue;
      for (std::size_t k = 0; k < 3; ++k) ++ranges.edges[static_cast<std::size_t>(std::min(t[k], t[(k + 1) % 3]) / ranges.width)];
    }
    progress.advance(static_cast<std::int64_t>(triangles.size()));
  });
  topology.unused_vertices = std::count(used.begin(), used.end(), false);
  if (joined) topology.components = joined->parts(used);
  return ranges;
}

/// The edges whose lower vertex lies in [low, high), as numbers: (lower - low, higher, whether it runs downwards). They fit in 64 bits.
std::vector<std::uint64_t> edges_of(const MeshSource& mesh, std::int64_t low, std::int64_t high, std::int64_t count, Progress& progress) {
  const auto vertices = static_cast<std::uint64_t>(mesh.vertices());
  std::vector<std::uint64_t> keys;
  keys.reserve(static_cast<std::size_t>(count));
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& t : triangles) {
      if (!has_edges(t)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [lower, higher] = std::minmax(t[k], t[(k + 1) % 3]);
        if (lower < low || lower >= high) continue;
        keys.push_back((static_cast<std::uint64_t>(lower - low) * vertices + static_cast<std::uint64_t>(higher)) * 2 + (t[k] == higher ? 1 : 0));
      }
    }
    progress.advance(static_cast<std::int64_t>(triangles.size()));
  });
  return keys;
}

void count_edges(std::vector<std::uint64_t>& keys, std::int64_t low, std::int64_t vertices, MeshTopology& topology, std::vector<BorderEdge>* border) {
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size();) {
    const std::uint64_t edge = keys[i] / 2;
    std::size_t end = i;
    while (end < keys.size() && keys[end] / 2 == edge) ++end;
    ++topology.edges;
    if (end - i == 1) {
      ++topology.border_edges;
      const std::int64_t lower = low + static_cast<std::int64_t>(edge / static_cast<std::uint64_t>(vertices));
      const auto higher = static_cast<std::int64_t>(edge % static_cast<std::uint64_t>(vertices));
      if (border) border->push_back(keys[i] % 2 == 0 ? BorderEdge{lower, higher} : BorderEdge{higher, lower});
    } else if (end - i > 2 || keys[i] == keys[i + 1]) {
      ++topology.non_manifold_edges;
    }
    i = end;
  }
}

}  // namespace

MeshTopology mesh_topology(const MeshSource& mesh, std::int64_t memory_bytes, Progress& progress, std::vector<BorderEdge>* border) {
  MeshTopology topology;
  progress.begin("Joining triangles", mesh.triangles());
  const Ranges ranges = survey(mesh, memory_bytes, progress, topology);
  progress.end();
  const std::int64_t most_edges = std::max<std::int64_t>(1, memory_bytes / 2 / 8);
  // Keys of one pass fit in 63 bits.
  const std::int64_t most_vertices = std::max<std::int64_t>(ranges.width, (std::int64_t{1} << 62) / std::max<std::int64_t>(1, mesh.vertices()));
  for (std::int64_t range = 0; range < most_ranges;) {
    const std::int64_t first = range;
    std::int64_t count = 0;
    do {
      count += ranges.edges[static_cast<std::size_t>(range++)];
    } while (range < most_ranges && count + ranges.edges[static_cast<std::size_t>(range)] <= most_edges && (range - first + 1) * ranges.width <= most_vertices);
    if (count == 0) continue;
    progress.begin("Sorting edges", mesh.triangles());
    std::vector<std::uint64_t> keys = edges_of(mesh, first * ranges.width, range * ranges.width, count, progress);
    progress.end();
    count_edges(keys, first * ranges.width, mesh.vertices(), topology, border);
  }
  return topology;
}

}  // namespace arete
