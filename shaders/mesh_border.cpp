#include "shaders/mesh_border.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace arete {
namespace {

constexpr std::size_t sides_at_once = std::size_t{1} << 22;

/// Lower vertex, higher vertex, and whether the triangle goes from the higher to the lower.
std::uint64_t key_of(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{std::min(from, to)} << 32 | std::uint64_t{std::max(from, to)} << 1 | (from > to ? 1 : 0);
}

void append_single_sides(std::vector<std::uint64_t>& keys, std::vector<BorderSide>& sides) {
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0, end; i < keys.size(); i = end) {
    for (end = i + 1; end < keys.size() && keys[end] >> 1 == keys[i] >> 1;) ++end;
    if (end - i > 1) continue;
    BorderSide side{static_cast<std::uint32_t>(keys[i] >> 32), static_cast<std::uint32_t>(keys[i] >> 1 & 0x7fffffff)};
    if (keys[i] & 1) std::swap(side.from, side.to);
    sides.push_back(side);
  }
}

/// By ranges of the lower vertex, so that few sides are in memory at a time.
std::vector<BorderSide> single_sides(const TriangleMesh& mesh) {
  std::vector<BorderSide> sides;
  const std::size_t passes = 3 * mesh.triangles.size() / sides_at_once + 1;
  const std::uint64_t count = mesh.vertices.size();
  std::vector<std::uint64_t> keys;
  for (std::size_t pass = 0; pass < passes; ++pass) {
    const std::uint64_t low = count * pass / passes, high = count * (pass + 1) / passes;
    keys.clear();
    for (const auto& corner : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = corner[k], to = corner[(k + 1) % 3], lower = std::min(from, to);
        if (lower >= low && lower < high) keys.push_back(key_of(from, to));
      }
    append_single_sides(keys, sides);
  }
  return sides;
}

/// Calls visit(row, first column, last column) for the cells that a line touches, and a little more; coordinates in cells.
template <class Visit>
void for_cells_on_line(double x0, double y0, double x1, double y1, Size size, const Visit& visit) {
  constexpr double more = 1e-6;
  if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
  const auto first = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(y0 - more)));
  const auto last = std::min(size.height - 1, static_cast<std::int64_t>(std::floor(y1 + more)));
  for (std::int64_t row = first; row <= last; ++row) {
    const auto at = [&](double y) { return y1 > y0 ? x0 + (std::clamp(y, y0, y1) - y0) / (y1 - y0) * (x1 - x0) : x0; };
    double left = at(static_cast<double>(row)), right = y1 > y0 ? at(static_cast<double>(row + 1)) : x1;
    if (left > right) std::swap(left, right);
    const auto from = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(left - more)));
    const auto to = std::min(size.width - 1, static_cast<std::int64_t>(std::floor(right + more)));
    if (from <= to) visit(row, from, to);
  }
}

}  // namespace

std::vector<BorderSide> find_border(const TriangleMesh& mesh) {
  std::vector<BorderSide> sides = single_sides(mesh), border;
  std::sort(sides.begin(), sides.end(), [](const BorderSide& a, const BorderSide& b) { return std::pair(a.from, a.to) < std::pair(b.from, b.to); });
  std::vector<char> taken(sides.size());
  const auto next_of = [&](std::uint32_t vertex) {
    auto side = std::lower_bound(sides.begin(), sides.end(), vertex, [](const BorderSide& s, std::uint32_t v) { return s.from < v; });
    while (side != sides.end() && side->from == vertex && taken[static_cast<std::size_t>(side - sides.begin())]) ++side;
    return side != sides.end() && side->from == vertex ? static_cast<std::size_t>(side - sides.begin()) : sides.size();
  };
  for (std::size_t start = 0; start < sides.size(); ++start) {
    if (taken[start]) continue;
    const std::size_t first = border.size();
    double twice_area = 0;
    const Point3& origin = mesh.vertices[sides[start].from];
    for (std::size_t i = start; i < sides.size(); i = sides[i].to == sides[start].from ? sides.size() : next_of(sides[i].to)) {
      taken[i] = 1;
      border.push_back(sides[i]);
      const Point3 a = subtract(mesh.vertices[sides[i].from], origin), b = subtract(mesh.vertices[sides[i].to], origin);
      twice_area += a[0] * b[1] - a[1] * b[0];
    }
    if (twice_area < 0)
      for (std::size_t i = first; i < border.size(); ++i) border[i].hole = true;
  }
  return border;
}

std::size_t end_of_loop(const std::vector<BorderSide>& border, std::size_t first) {
  std::size_t end = first + 1;
  while (end < border.size() && border[end].from == border[end - 1].to && border[end - 1].to != border[first].from) ++end;
  return end;
}

Raster<std::uint8_t> cells_of_holes(const TriangleMesh& mesh, const MeshGrid& grid, std::vector<BorderSide>& border) {
  if (std::none_of(border.begin(), border.end(), [](const BorderSide& side) { return side.hole; })) return {};
  Raster<std::uint8_t> cells(grid.size.width, grid.size.height, 0);
  const auto column = [&](std::uint32_t vertex) { return (mesh.vertices[vertex][0] - grid.x) / grid.cell.x_m; };
  const auto row = [&](std::uint32_t vertex) { return (grid.y - mesh.vertices[vertex][1]) / grid.cell.y_m; };
  const auto mark = [&](bool holes, std::uint8_t value) {
    for (const BorderSide& side : border)
      if (side.hole == holes)
        for_cells_on_line(column(side.from), row(side.from), column(side.to), row(side.to), grid.size, [&](std::int64_t y, std::int64_t from, std::int64_t to) {
          for (std::int64_t x = from; x <= to; ++x) cells(x, y) = value;
        });
  };
  // Where the border of holes crosses the middles of rows, and whether upwards.
  std::vector<std::vector<std::pair<double, int>>> crossings(static_cast<std::size_t>(grid.size.height));
  for (const BorderSide& side : border) {
    if (!side.hole) continue;
    double x0 = column(side.from), y0 = row(side.from), x1 = column(side.to), y1 = row(side.to);
    const int way = y0 > y1 ? 1 : -1;
    if (way > 0) std::swap(x0, x1), std::swap(y0, y1);
    for (auto y = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(y0 - 0.5))); y < grid.size.height && static_cast<double>(y) + 0.5 < y1; ++y)
      crossings[static_cast<std::size_t>(y)].emplace_back(x0 + (static_cast<double>(y) + 0.5 - y0) / (y1 - y0) * (x1 - x0), way);
  }
  for (std::int64_t y = 0; y < grid.size.height; ++y) {
    auto& at = crossings[static_cast<std::size_t>(y)];
    std::sort(at.begin(), at.end());
    int winding = 0;
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      winding += at[i].second;
      if (winding == 0) continue;
      const std::int64_t end = std::min<std::int64_t>(grid.size.width, std::llround(at[i + 1].first));
      for (auto x = std::max<std::int64_t>(0, std::llround(at[i].first)); x < end; ++x) cells(x, y) = 1;
    }
  }
  // Islands, loop by loop.
  for (std::size_t first = 0, end; first < border.size(); first = end) {
    std::size_t inside = 0;
    end = end_of_loop(border, first);
    for (std::size_t i = first; i < end; ++i) {
      const auto at = [](double place, std::int64_t count) { return std::clamp(static_cast<std::int64_t>(std::floor(place)), std::int64_t{0}, count - 1); };
      inside += cells(at(column(border[i].from), grid.size.width), at(row(border[i].from), grid.size.height));
    }
    if (2 * inside > end - first)
      for (std::size_t i = first; i < end; ++i) border[i].hole = true;
  }
  mark(true, 1);
  mark(false, 0);
  return cells;
}

}  // namespace arete
