#include "gis/mesh/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gis/mesh/exact.h"

namespace arete {
namespace {

/// A vertex of the border in the row of cells that it lies in.
struct BorderVertex {
  std::int64_t band = 0;
  std::int64_t column = 0, row = 0;
  std::int64_t vertex = 0;
  bool operator<(const BorderVertex& other) const {
    return std::array{band, column, row, vertex} < std::array{other.band, other.column, other.row, other.vertex};
  }
};

std::int64_t band_of(std::int64_t row) { return row >> 30; }
static_assert(cell_units == std::int64_t{1} << 30);

std::vector<BorderVertex> border_vertices(std::span<const BorderEdge> border, RasterPoints& points) {
  std::vector<std::int64_t> indices;
  for (const BorderEdge& edge : border) indices.insert(indices.end(), edge.begin(), edge.end());
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  std::vector<BorderVertex> vertices;
  vertices.reserve(indices.size());
  for (const std::int64_t index : indices) {
    const RasterPoint& p = points.at(index);
    vertices.push_back({band_of(p.row), p.column, p.row, index});
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

/// Strictly between a and b, on the straight line.
bool inside_edge(const RasterPoint& a, const RasterPoint& b, const BorderVertex& p) {
  const Int128 dx = b.column - a.column, dy = b.row - a.row, px = p.column - a.column, py = p.row - a.row;
  if (dx * py != dy * px) return false;
  const Int128 along = dx * px + dy * py;
  return along > 0 && along < dx * dx + dy * dy;
}

/// The columns that the edge passes in a band, and a little more.
std::array<std::int64_t, 2> columns_in_band(const RasterPoint& a, const RasterPoint& b, std::int64_t band) {
  const auto [low, high] = std::minmax(a.column, b.column);
  if (a.row == b.row) return {low, high};
  const double slope = static_cast<double>(b.column - a.column) / static_cast<double>(b.row - a.row);
  const auto at = [&](std::int64_t row) { return static_cast<double>(a.column) + slope * static_cast<double>(row - a.row); };
  const auto [rows_low, rows_high] = std::minmax(a.row, b.row);
  const double from = at(std::max(rows_low, band * cell_units)), to = at(std::min(rows_high, (band + 1) * cell_units));
  // A double holds places of 2^61 units to 2^9.
  constexpr double more = 4096;
  const auto left = static_cast<std::int64_t>(std::min(from, to) - more), right = static_cast<std::int64_t>(std::max(from, to) + more);
  return {std::max(low, left), std::min(high, right)};
}

}  // namespace

MeshFault find_t_junctions(std::span<const BorderEdge> border, RasterPoints& points) {
  const std::vector<BorderVertex> vertices = border_vertices(border, points);
  constexpr std::int64_t lowest = std::numeric_limits<std::int64_t>::min();
  const auto first_of = [&](std::int64_t band, std::int64_t column) {
    return std::lower_bound(vertices.begin(), vertices.end(), BorderVertex{band, column, lowest, lowest});
  };
  MeshFault found;
  for (const BorderEdge& edge : border) {
    const RasterPoint a = points.at(edge[0]), b = points.at(edge[1]);
    const std::int64_t last = band_of(std::max(a.row, b.row));
    // Only rows that have vertices: an edge may cross very many.
    for (auto row = first_of(band_of(std::min(a.row, b.row)), lowest); row != vertices.end() && row->band <= last; row = first_of(row->band + 1, lowest)) {
      const auto [left, right] = columns_in_band(a, b, row->band);
      for (auto p = first_of(row->band, left); p != vertices.end() && p->band == row->band && p->column <= right; ++p)
        if (inside_edge(a, b, *p)) found.add(p->vertex);
    }
  }
  return found;
}

MeshFault find_cracks(std::span<const BorderEdge> border, RasterPoints& points) {
  using Place = std::array<std::int64_t, 2>;
  struct Edge {
    std::array<Place, 2> ends;  // the lesser first
    std::int64_t vertex;
    bool operator<(const Edge& other) const { return ends != other.ends ? ends < other.ends : vertex < other.vertex; }
  };
  std::vector<Edge> edges;
  edges.reserve(border.size());
  for (const BorderEdge& edge : border) {
    const RasterPoint a = points.at(edge[0]), b = points.at(edge[1]);
    std::array<Place, 2> ends{Place{a.column, a.row}, Place{b.column, b.row}};
    if (ends[1] < ends[0]) std::swap(ends[0], ends[1]);
    edges.push_back({ends, edge[0]});
  }
  std::sort(edges.begin(), edges.end());
  MeshFault found;
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i].ends == edges[i - 1].ends) found.add(edges[i].vertex);
  return found;
}

}  // namespace arete
