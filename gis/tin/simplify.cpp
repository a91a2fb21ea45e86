#include "gis/tin/simplify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "gis/tin/greedy_insertion.h"
#include "gis/tin/heights.h"
#include "gis/tin/triangle_errors.h"

namespace arete {
namespace {

constexpr double min_shape = 0.1;       // height of a triangle over its longest edge
constexpr std::size_t max_ring = 60;    // vertices with more neighbours are left alone

/// Height over longest edge; negative where the triangle is turned over.
double shape(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c) {
  return static_cast<double>(orientation(mesh, a, b, c)) / longest_squared(mesh, a, b, c);
}

/// What cells allow the elevation of a vertex to be, and the sums of which the least-squares elevation is made: a cell of height h is
/// under the mesh at z weight + rest, and wants it at h - rest.
struct Interval {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  double weights = 0, products = 0;  ///< sums of weight², weight (h - rest)

  bool empty() const { return low > high; }
};

class Simplifier {
 public:
  Simplifier(TileMesh& mesh, const TileCells& cells, const TileBound& bound)
      : mesh_(mesh), cells_(cells), bound_(bound), stirred_(mesh.x.size(), 1), stirring_(mesh.x.size(), 0) {}

  /// Tries to remove the vertices beside which something was removed since they were tried; at first, all.
  void collapse_edges() {
    for (std::int32_t v = 0; v < mesh_.vertices(); ++v)
      if (stirred_[v] && mesh_.leaving[v] >= 0 && !mesh_.held[v]) remove(v);
    stirred_.swap(stirring_);
    std::fill(stirring_.begin(), stirring_.end(), std::uint8_t{0});
  }

  /// The next collapse_edges() tries all vertices again.
  void stir_all() { std::fill(stirred_.begin(), stirred_.end(), std::uint8_t{1}); }

  void fit_heights() {
    for (std::int32_t v = 0; v < mesh_.vertices(); ++v) {
      if (mesh_.leaving[v] < 0 || mesh_.held[v]) continue;
      collect_ring(mesh_, v, ring_);
      Interval interval;
      for (std::size_t i = 0; i < ring_.triangles(); ++i) narrow(v, ring_.vertices[i], ring_.after(i), interval);
      if (const std::optional<double> z = best_height(interval)) mesh_.z[v] = *z;
    }
  }

  void flip_edges() {
    for (std::int32_t edge = 0; edge < static_cast<std::int32_t>(mesh_.origin.size()); ++edge) {
      const std::int32_t twin = mesh_.twin[edge];
      if (mesh_.origin[edge] < 0 || twin < edge || mesh_.fixed[edge]) continue;
      const std::int32_t apex = mesh_.origin[previous_edge(edge)], beyond = mesh_.origin[previous_edge(twin)];
      const std::int32_t right = mesh_.origin[edge], left = mesh_.origin[next_edge(edge)];
      const double least = std::min(min_shape, std::min(shape(mesh_, apex, right, left), shape(mesh_, beyond, left, right)));
      if (shape(mesh_, apex, beyond, left) < least || shape(mesh_, beyond, apex, right) < least) continue;
      if (is_too_long(mesh_, apex, beyond, left, bound_) || is_too_long(mesh_, beyond, apex, right, bound_)) continue;
      const double now = fit(apex, right, left).squares + fit(beyond, left, right).squares;
      const TriangleFit first = fit(apex, beyond, left);
      if (!first.keeps || first.squares >= now) continue;
      const TriangleFit second = fit(beyond, apex, right);
      if (second.keeps && first.squares + second.squares < 0.999 * now) flip_edge(mesh_, edge);
    }
  }

 private:
  TriangleFit fit(std::int32_t a, std::int32_t b, std::int32_t c) const { return fit_of(mesh_, cells_, a, b, c, bound_); }

  /// Takes from the interval what the cells of the triangle (v, a, b) do not allow. To rounding: what comes of it is proven at the end.
  void narrow(std::int32_t v, std::int32_t a, std::int32_t b, Interval& interval) const {
    const double ax = mesh_.x[a] - mesh_.x[v], ay = mesh_.y[a] - mesh_.y[v], bx = mesh_.x[b] - mesh_.x[v], by = mesh_.y[b] - mesh_.y[v];
    const double per_area = 1 / (ax * by - ay * bx), za = mesh_.z[a], zb = mesh_.z[b];
    const double a_along_x = by * per_area * mesh_.units, b_along_x = -ay * per_area * mesh_.units;
    double error = bound_.error_m;
    if (bound_.displacement.any() || bound_.noise_cells > 0) {
      const TrianglePlane plane = plane_of(mesh_, v, a, b);
      error = allowance(mesh_, plane, v, a, b, bound_) / plane.area2;
    }
    error += 1e-12 * error;
    Interval narrowed = interval;
    for_each_span(mesh_, cells_, v, a, b, [&](std::int32_t row, std::int32_t first, std::int32_t last) {
      if (narrowed.empty()) return;
      const float* heights = cells_.row(row);
      const double dx = first * mesh_.units - mesh_.x[v], dy = row * mesh_.units - mesh_.y[v];
      double of_a = (dx * by - dy * bx) * per_area, of_b = (ax * dy - ay * dx) * per_area;
      double low = narrowed.low, high = narrowed.high, weights = 0, products = 0;
      for (std::int32_t column = first; column <= last; ++column, of_a += a_along_x, of_b += b_along_x) {
        const double weight = 1 - of_a - of_b, want = heights[column] - of_a * za - of_b * zb;
        if (weight > 1e-9) {
          if (want - error > low * weight) low = (want - error) / weight;
          if (want + error < high * weight) high = (want + error) / weight;
        } else if (std::abs(want) > error + 1e-9) {
          low = std::numeric_limits<double>::infinity();
        }
        weights += weight * weight;
        products += weight * want;
      }
      narrowed = {low, high, narrowed.weights + weights, narrowed.products + products};
    });
    interval = narrowed;
  }

  /// The elevation in the interval with the least squared errors; none where the interval is empty or no cell asks for anything.
  std::optional<double> best_height(const Interval& interval) const {
    if (!(interval.weights > 0)) return std::nullopt;
    const double step = bound_.height_step_m;
    const double low = ceil_height(interval.low, step), high = floor_height(interval.high, step);
    if (low > high) return std::nullopt;
    return std::clamp(round_height(interval.products / interval.weights, step), low, high);
  }

  /// Whether moving the vertex of ring_ onto `to` leaves every triangle in good shape and the surface a surface.
  bool can_move_to(std::int32_t from, std::int32_t to) {
    for (std::size_t i = 0; i < ring_.triangles(); ++i) {
      const std::int32_t a = ring_.vertices[i], b = ring_.after(i);
      if (a == to || b == to) continue;
      const double now = shape(mesh_, to, a, b);
      if (now < min_shape && (now <= 0 || now < shape(mesh_, from, a, b))) return false;
      if (is_too_long(mesh_, to, a, b, bound_)) return false;
    }
    collect_ring(mesh_, to, other_);
    int common = 0;
    for (const std::int32_t v : other_.vertices) common += std::find(ring_.vertices.begin(), ring_.vertices.end(), v) != ring_.vertices.end();
    return common == 2;
  }

  /// Which triangle of ring_ has the vertex in it when all fan out from `to`.
  std::size_t triangle_under(std::int32_t from, std::int32_t to) const {
    for (std::size_t i = 0; i < ring_.triangles(); ++i) {
      const std::int32_t a = ring_.vertices[i], b = ring_.after(i);
      if (a != to && b != to && orientation(mesh_, to, a, from) >= 0 && orientation(mesh_, to, from, b) >= 0) return i;
    }
    return 0;
  }

  /// The elevation of `to` at which the vertex of ring_ can be moved onto it. Leaves the ring of `to` in other_.
  std::optional<double> height_to_move(std::int32_t from, std::int32_t to) {
    if (!can_move_to(from, to)) return std::nullopt;
    Interval interval;
    // First the triangle that will lie where the vertex was: the vertex is there for its cells.
    const std::size_t under = triangle_under(from, to);
    for (std::size_t k = 0; k < ring_.triangles(); ++k) {
      const std::size_t i = (under + k) % ring_.triangles();
      const std::int32_t a = ring_.vertices[i], b = ring_.after(i);
      if (a == to || b == to) continue;
      narrow(to, a, b, interval);
      if (interval.empty()) return std::nullopt;
    }
    if (mesh_.held[to]) return interval.low <= mesh_.z[to] && mesh_.z[to] <= interval.high ? std::optional(mesh_.z[to]) : std::nullopt;
    for (std::size_t i = 0; i < other_.triangles(); ++i) {
      const std::int32_t a = other_.vertices[i], b = other_.after(i);
      if (a == from || b == from) continue;
      narrow(to, a, b, interval);
      if (interval.empty()) return std::nullopt;
    }
    return best_height(interval);
  }

  void remove(std::int32_t v) {
    collect_ring(mesh_, v, ring_);
    if (!ring_.closed || ring_.vertices.size() > max_ring) return;
    for (const std::int32_t to : ring_.vertices) {
      const std::optional<double> z = height_to_move(v, to);
      if (!z) continue;
      mesh_.z[to] = *z;
      collapse_edge(mesh_, v, ring_, to);
      collect_ring(mesh_, to, ring_);
      for (const std::int32_t neighbour : ring_.vertices) stirring_[neighbour] = 1;
      stirring_[to] = 1;
      return;
    }
  }

  TileMesh& mesh_;
  const TileCells& cells_;
  const TileBound& bound_;
  std::vector<std::uint8_t> stirred_, stirring_;  // per vertex: something beside it was removed, in the last pass and in this one
  Ring ring_, other_;
};

}  // namespace

void simplify(TileMesh& mesh, const TileCells& cells, const TileBound& bound, int passes) {
  if (passes == 0) return;
  mesh = sort_mesh(mesh);
  Simplifier simplifier(mesh, cells, bound);
  for (int pass = 0; pass < passes; ++pass) {
    if (pass > 0) {
      simplifier.fit_heights();
      simplifier.flip_edges();
    }
    if (pass == 1) simplifier.stir_all();
    simplifier.collapse_edges();
  }
  // Elevations were found to rounding. What that left beyond the bound, hardly ever anything, gets vertices again.
  mesh = sort_mesh(mesh);
  mesh.leaving.clear();
  insert_greedily(mesh, cells, bound);
  link_vertices(mesh);
}

}  // namespace arete
