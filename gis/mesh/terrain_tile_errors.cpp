#include "gis/mesh/terrain_tile_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace arete {
namespace {

constexpr double near_edge = 1e-6;
constexpr int bins = 256;                              // along each side
constexpr double bin_size = (quantized_end + 1.0) / bins;

int bin_of(double place) { return std::clamp(static_cast<int>(std::floor(place / bin_size)), 0, bins - 1); }

/// Points sorted by the bin that they lie in.
class BinnedPoints {
 public:
  explicit BinnedPoints(std::span<const TerrainPoint> points) : first_(bins * bins + 1), order_(points.size()) {
    const auto bin = [](const TerrainPoint& p) { return static_cast<std::size_t>(bin_of(p.v) * bins + bin_of(p.u)); };
    for (const TerrainPoint& p : points) ++first_[bin(p) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) order_[next[bin(points[i])]++] = i;
  }
  /// Points of the bins [left, right] of one row of bins.
  std::span<const std::size_t> of_row(int row, int left, int right) const {
    const std::size_t from = first_[static_cast<std::size_t>(row * bins + left)], to = first_[static_cast<std::size_t>(row * bins + right + 1)];
    return {order_.data() + from, to - from};
  }

 private:
  std::vector<std::size_t> first_, order_;
};

struct Corner {
  double u, v, height;
};
using Triangle = std::array<Corner, 3>;

/// What a triangle spans of a strip of v, in u.
std::pair<double, double> span_in_strip(const Triangle& t, double low, double high) {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  const auto reach = [&](double u) { left = std::min(left, u), right = std::max(right, u); };
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner &a = t[i], &b = t[(i + 1) % 3];
    if (a.v >= low && a.v <= high) reach(a.u);
    for (const double v : {low, high})
      if ((a.v - v) * (b.v - v) < 0) reach(a.u + (b.u - a.u) * (v - a.v) / (b.v - a.v));
  }
  return {left, right};
}

double twice_area(const Triangle& t) { return (t[1].u - t[0].u) * (t[2].v - t[0].v) - (t[1].v - t[0].v) * (t[2].u - t[0].u); }

/// Calls body(point) for the points of the bins that a triangle touches.
template <class Body>
void for_points_near(const BinnedPoints& points, const Triangle& t, Body&& body) {
  const auto [low, high] = std::minmax({t[0].v, t[1].v, t[2].v});
  for (int row = bin_of(low - 1); row <= bin_of(high + 1); ++row) {
    const auto [left, right] = span_in_strip(t, row * bin_size - 1, (row + 1) * bin_size + 1);
    if (left > right) continue;
    for (const std::size_t point : points.of_row(row, bin_of(left - 1), bin_of(right + 1))) body(point);
  }
}

/// Distances of a place from the sides of a triangle, inwards, and its height there.
struct Hit {
  double inside;  ///< the least distance; negative: outside
  double height;
};

Hit look_at(const Triangle& t, double area, const TerrainPoint& p) {
  Hit hit{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner &a = t[(i + 1) % 3], &b = t[(i + 2) % 3];
    const double weight = (b.u - a.u) * (p.v - a.v) - (b.v - a.v) * (p.u - a.u);
    hit.inside = std::min(hit.inside, weight / std::hypot(b.u - a.u, b.v - a.v));
    hit.height += weight / area * t[i].height;
  }
  return hit;
}

}  // namespace

TerrainTileErrors compare_terrain_tile(const QuantizedMesh& tile, std::span<const TerrainPoint> points) {
  TerrainTileErrors found;
  found.error_m.assign(points.size(), std::nan(""));
  std::vector<std::uint8_t> inside(points.size());
  const BinnedPoints binned(points);
  for (std::size_t t = 0; t < tile.triangles.size(); t += 3) {
    Triangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t vertex = tile.triangles[t + i];
      triangle[i] = {static_cast<double>(tile.u[vertex]), static_cast<double>(tile.v[vertex]), tile.height_m(vertex)};
    }
    const double area = twice_area(triangle);
    if (!(area > 0)) {
      ++found.clockwise;
      continue;
    }
    for_points_near(binned, triangle, [&](std::size_t i) {
      const Hit hit = look_at(triangle, area, points[i]);
      if (hit.inside < -near_edge) return;
      if (hit.inside > near_edge) inside[i] = static_cast<std::uint8_t>(std::min(inside[i] + 1, 2));
      if (std::isnan(points[i].height_m)) return;
      const double error = std::abs(hit.height - points[i].height_m);
      if (!(found.error_m[i] >= error)) found.error_m[i] = error;
    });
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = found.error_m[i];
    found.folds += inside[i] > 1;
    if (std::isnan(points[i].height_m)) {
      found.covered_voids += inside[i] > 0;
    } else if (std::isnan(error)) {
      ++found.uncovered;
    } else {
      ++found.compared;
      found.squares += error * error;
      found.max_error_m = std::max(found.max_error_m, error);
    }
  }
  return found;
}

TerrainTileEdges find_tile_edges(const QuantizedMesh& tile) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;  // triangles to the left and to the right
  for (std::size_t t = 0; t < tile.triangles.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = tile.triangles[t + i], b = tile.triangles[t + (i + 1) % 3];
      if (a < b) ++edges[{a, b}].first;
      else ++edges[{b, a}].second;
    }
  const auto on_side = [&](std::uint32_t a, std::uint32_t b) {
    return (tile.u[a] == tile.u[b] && (tile.u[a] == 0 || tile.u[a] == quantized_end)) || (tile.v[a] == tile.v[b] && (tile.v[a] == 0 || tile.v[a] == quantized_end));
  };
  TerrainTileEdges found;
  for (const auto& [edge, sides] : edges) {
    const bool border = on_side(edge.first, edge.second);
    if (sides.first > 1 || sides.second > 1 || edge.first == edge.second || (border && sides.first + sides.second != 1)) ++found.not_manifold;
    else if (!border && sides.first + sides.second == 1) ++found.inner_borders;
  }
  return found;
}

std::vector<SideVertex> side_vertices(const QuantizedMesh& tile, const std::vector<std::uint32_t>& side, const std::vector<std::uint16_t>& along) {
  std::vector<SideVertex> vertices;
  for (const std::uint32_t vertex : side) vertices.push_back({along[vertex], tile.height_m(vertex)});
  std::sort(vertices.begin(), vertices.end(), [](const SideVertex& a, const SideVertex& b) { return std::pair(a.at, a.height_m) < std::pair(b.at, b.height_m); });
  return vertices;
}

}  // namespace arete
