// Notay, Y.: An aggregation-based algebraic multigrid method. Electronic Transactions on Numerical Analysis 37, 2010.
// The coarse operator is the Galerkin product for piecewise constant prolongation: edges between aggregates add up.
#include "core/terrain/fill_voids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "core/support/error.h"

namespace arete {
namespace {

enum Direction { east, south, west, north };
constexpr int none = -1;
constexpr double wanted_energy_share = 1e-6;  // of the square root of the energy
constexpr int most_iterations = 200;          // 20 is usual; a bound, so that no input runs for ever

using Vector = std::vector<double>;

/// One grid of the multigrid: the unknown cells only, each with its four neighbours among them.
struct Level {
  struct Node {
    std::array<int, 4> neighbour = {none, none, none, none};
    std::array<float, 4> weight = {0, 0, 0, 0};
    float diagonal = 0;
    int x = 0, y = 0;
    int parent = none;  // on the next level
  };
  std::vector<Node> nodes;
  Vector solution, right, residual;
  std::size_t size() const { return nodes.size(); }

  void connect(int a, int b, Direction forward, float weight) {
    const auto back = static_cast<std::size_t>((forward + 2) % 4);
    auto& from = nodes[static_cast<std::size_t>(a)];
    auto& to = nodes[static_cast<std::size_t>(b)];
    from.neighbour[forward] = b;
    from.weight[forward] += weight;
    to.neighbour[back] = a;
    to.weight[back] += weight;
  }
  double pull(const Node& node, const Vector& v) const {
    double sum = 0;
    for (std::size_t d = 0; d < 4; ++d)
      if (node.neighbour[d] != none) sum += static_cast<double>(node.weight[d]) * v[static_cast<std::size_t>(node.neighbour[d])];
    return sum;
  }
  void apply(const Vector& v, Vector& out) const {
    for (std::size_t i = 0; i < size(); ++i) out[i] = static_cast<double>(nodes[i].diagonal) * v[i] - pull(nodes[i], v);
  }
};

/// The void cells, and what the valid cells around them pull on each (into `right`, relative to `level`).
Level find_voids(RasterView<const float> elevation, double level) {
  Level fine;
  std::vector<int> above(static_cast<std::size_t>(elevation.width), none);
  for (std::int64_t y = 0; y < elevation.height; ++y) {
    int left = none;
    for (std::int64_t x = 0; x < elevation.width; ++x) {
      int& up = above[static_cast<std::size_t>(x)];
      if (!is_void(elevation(x, y))) {
        left = up = none;
        continue;
      }
      if (fine.size() == static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw Error(ErrorKind::memory, "filling voids: more than 2147483647 void cells");
      const int here = static_cast<int>(fine.size());
      Level::Node node;
      node.x = static_cast<int>(x);
      node.y = static_cast<int>(y);
      double pulled = 0;
      for (const auto& [nx, ny] : {std::pair{x + 1, y}, {x, y + 1}, {x - 1, y}, {x, y - 1}}) {
        if (nx < 0 || ny < 0 || nx >= elevation.width || ny >= elevation.height) continue;
        node.diagonal += 1;
        if (!is_void(elevation(nx, ny))) pulled += static_cast<double>(elevation(nx, ny)) - level;
      }
      fine.nodes.push_back(node);
      fine.right.push_back(pulled);
      if (left != none) fine.connect(left, here, east, 1);
      if (up != none) fine.connect(up, here, south, 1);
      left = up = here;
    }
  }
  return fine;
}

/// Joins blocks of 2 x 2 cells.
Level coarsen_level(Level& fine) {
  Level coarse;
  std::vector<int> row;  // coarse nodes of the coarse row at hand, by column
  int row_y = none;
  for (Level::Node& node : fine.nodes) {
    const auto x = static_cast<std::size_t>(node.x / 2);
    if (node.y / 2 != row_y) {
      row.assign(row.size(), none);
      row_y = node.y / 2;
    }
    if (x >= row.size()) row.resize(x + 1, none);
    if (row[x] == none) {
      row[x] = static_cast<int>(coarse.size());
      Level::Node joined;
      joined.x = node.x / 2;
      joined.y = row_y;
      coarse.nodes.push_back(joined);
    }
    node.parent = row[x];
    coarse.nodes[static_cast<std::size_t>(node.parent)].diagonal += node.diagonal;
  }
  for (const Level::Node& node : fine.nodes)
    for (const Direction d : {east, south}) {
      if (node.neighbour[d] == none) continue;
      const int other = fine.nodes[static_cast<std::size_t>(node.neighbour[d])].parent;
      if (other == node.parent)
        coarse.nodes[static_cast<std::size_t>(other)].diagonal -= 2 * node.weight[d];
      else
        coarse.connect(node.parent, other, d, node.weight[d]);
    }
  return coarse;
}

/// All levels; the last has one node.
std::vector<Level> make_levels(Level fine) {
  std::vector<Level> levels;
  levels.push_back(std::move(fine));
  while (levels.back().size() > 1) levels.push_back(coarsen_level(levels.back()));
  for (Level& level : levels) {
    level.solution.assign(level.size(), 0);
    level.residual.assign(level.size(), 0);
    level.right.resize(level.size(), 0);
  }
  return levels;
}

void smooth(Level& level, bool forward) {
  const auto relax = [&](std::size_t i) {
    level.solution[i] = (level.right[i] + level.pull(level.nodes[i], level.solution)) / static_cast<double>(level.nodes[i].diagonal);
  };
  if (forward)
    for (std::size_t i = 0; i < level.size(); ++i) relax(i);
  else
    for (std::size_t i = level.size(); i-- > 0;) relax(i);
}

/// Improves levels[depth].solution for its right side; symmetric, as conjugate gradients need it.
void cycle(std::vector<Level>& levels, std::size_t depth) {
  Level& level = levels[depth];
  if (depth + 1 == levels.size()) {
    level.solution[0] = level.right[0] / static_cast<double>(level.nodes[0].diagonal);
    return;
  }
  Level& coarse = levels[depth + 1];
  smooth(level, true);
  level.apply(level.solution, level.residual);
  std::fill(coarse.right.begin(), coarse.right.end(), 0.0);
  std::fill(coarse.solution.begin(), coarse.solution.end(), 0.0);
  for (std::size_t i = 0; i < level.size(); ++i)
    coarse.right[static_cast<std::size_t>(level.nodes[i].parent)] += level.right[i] - level.residual[i];
  // Twice: the W-cycle, which keeps the convergence independent of the number of levels.
  cycle(levels, depth + 1);
  cycle(levels, depth + 1);
  for (std::size_t i = 0; i < level.size(); ++i)
    level.solution[i] += coarse.solution[static_cast<std::size_t>(level.nodes[i].parent)];
  smooth(level, false);
}

double dot(const Vector& a, const Vector& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

/// Conjugate gradients. The finest level's `right` and `solution` serve the preconditioner.
int solve(std::vector<Level>& levels, Vector& x) {
  Level& fine = levels.front();
  const std::size_t n = fine.size();
  Vector direction(n, 0), image(n);
  x.assign(n, 0);
  Vector& residual = fine.right;
  double energy = 0, first = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    std::fill(fine.solution.begin(), fine.solution.end(), 0.0);
    cycle(levels, 0);
    const double next = dot(residual, fine.solution);
    if (iteration == 0) first = next;
    if (!(next > first * wanted_energy_share * wanted_energy_share)) return iteration;
    const double keep = iteration == 0 ? 0 : next / energy;
    energy = next;
    for (std::size_t i = 0; i < n; ++i) direction[i] = fine.solution[i] + keep * direction[i];
    fine.apply(direction, image);
    const double step = energy / dot(direction, image);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += step * direction[i];
      residual[i] -= step * image[i];
    }
  }
  return most_iterations;
}

/// Holds each hole between the lowest and the highest valid cell of its rim, and writes it.
void write_holes(const Level& fine, const Vector& x, double level, RasterView<float> elevation) {
  std::vector<bool> seen(fine.size(), false);
  std::vector<int> hole;
  std::vector<float> filled(fine.size());
  for (std::size_t start = 0; start < fine.size(); ++start) {
    if (seen[start]) continue;
    hole.assign(1, static_cast<int>(start));
    seen[start] = true;
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    for (std::size_t k = 0; k < hole.size(); ++k) {
      const Level::Node& node = fine.nodes[static_cast<std::size_t>(hole[k])];
      for (const auto& [nx, ny] :
           {std::pair{node.x + 1, node.y}, {node.x, node.y + 1}, {node.x - 1, node.y}, {node.x, node.y - 1}}) {
        if (nx < 0 || ny < 0 || nx >= elevation.width || ny >= elevation.height || is_void(elevation(nx, ny))) continue;
        lowest = std::min(lowest, elevation(nx, ny));
        highest = std::max(highest, elevation(nx, ny));
      }
      for (const int next : node.neighbour) {
        if (next == none || seen[static_cast<std::size_t>(next)]) continue;
        seen[static_cast<std::size_t>(next)] = true;
        hole.push_back(next);
      }
    }
    for (const int i : hole)
      filled[static_cast<std::size_t>(i)] = std::clamp(static_cast<float>(x[static_cast<std::size_t>(i)] + level), lowest, highest);
  }
  for (std::size_t i = 0; i < fine.size(); ++i) elevation(fine.nodes[i].x, fine.nodes[i].y) = filled[i];
}

/// The mean of the valid cells: the solver works on what is left, which keeps its sums small.
double mean_elevation(RasterView<const float> elevation) {
  double sum = 0;
  std::int64_t valid = 0;
  for (std::int64_t y = 0; y < elevation.height; ++y)
    for (std::int64_t x = 0; x < elevation.width; ++x) {
      if (is_void(elevation(x, y))) continue;
      sum += static_cast<double>(elevation(x, y));
      ++valid;
    }
  if (valid == 0)
    throw Error(ErrorKind::input, "filling voids: all " + std::to_string(elevation.size().cells()) +
                                      " cells are void, there is nothing to interpolate from");
  return sum / static_cast<double>(valid);
}

}  // namespace

VoidFill fill_voids(RasterView<float> elevation) {
  const double level = mean_elevation(elevation);
  Level voids = find_voids(elevation, level);
  if (voids.size() == 0) return {};
  std::vector<Level> levels = make_levels(std::move(voids));
  Vector x;
  VoidFill fill;
  fill.iterations = solve(levels, x);
  fill.cells = static_cast<std::int64_t>(levels.front().size());
  write_holes(levels.front(), x, level, elevation);
  return fill;
}

}  // namespace arete
