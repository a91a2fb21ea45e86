#include "gis/mesh/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/random.h"
#include "gis/mesh/exact.h"
#include "gis/mesh/mesh_blocks.h"

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

namespace {

std::uint64_t hash_of(const RasterPoint& p) { return hash_position(0, static_cast<std::uint64_t>(p.column), static_cast<std::uint64_t>(p.row)); }

template <class Visit>
void for_points(const RasterPoints& points, const Visit& visit) {
  std::vector<RasterPoint> block;
  for (std::int64_t first = 0; first < points.size(); first += mesh_block) {
    block.resize(static_cast<std::size_t>(std::min(mesh_block, points.size() - first)));
    points.read(first, block);
    for (std::size_t i = 0; i < block.size(); ++i) visit(first + static_cast<std::int64_t>(i), block[i]);
  }
}

/// The hashes that more than one point has, sorted.
std::vector<std::uint64_t> repeated_hashes(const RasterPoints& points, std::int64_t memory_bytes, Progress& progress) {
  const auto passes = static_cast<std::uint64_t>(points.size() * 8 / std::max<std::int64_t>(memory_bytes, 1 << 20) + 1);
  std::vector<std::uint64_t> repeated, hashes;
  progress.begin("Sorting vertices", static_cast<std::int64_t>(passes));
  for (std::uint64_t pass = 0; pass < passes; ++pass) {
    hashes.clear();
    for_points(points, [&](std::int64_t, const RasterPoint& p) {
      const std::uint64_t hash = hash_of(p);
      if (passes == 1 || hash % passes == pass) hashes.push_back(hash);
    });
    std::sort(hashes.begin(), hashes.end());
    for (std::size_t i = 1; i < hashes.size(); ++i)
      if (hashes[i] == hashes[i - 1] && (repeated.empty() || repeated.back() != hashes[i])) repeated.push_back(hashes[i]);
    progress.advance(1);
  }
  progress.end();
  std::sort(repeated.begin(), repeated.end());
  return repeated;
}

}  // namespace

MeshFault find_duplicate_vertices(const RasterPoints& points, std::int64_t memory_bytes, Progress& progress) {
  MeshFault found;
  const std::vector<std::uint64_t> repeated = repeated_hashes(points, memory_bytes, progress);
  if (repeated.empty()) return found;
  struct Place {
    std::int64_t column, row, vertex;
    bool operator<(const Place& other) const { return std::array{column, row, vertex} < std::array{other.column, other.row, other.vertex}; }
  };
  std::vector<Place> places;
  for_points(points, [&](std::int64_t index, const RasterPoint& p) {
    if (std::binary_search(repeated.begin(), repeated.end(), hash_of(p))) places.push_back({p.column, p.row, index});
  });
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i].column == places[i - 1].column && places[i].row == places[i - 1].row) found.add(places[i].vertex);
  return found;
}

}  // namespace arete
