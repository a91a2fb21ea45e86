#include "gis/tin/displaced_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/terrain/raster.h"
#include "gis/tin/triangle_errors.h"

namespace arete {
namespace {

constexpr double near = 1e-7;  // of a cell

/// What a triangle has between two lines along x.
struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double x) { low = std::min(low, x), high = std::max(high, x); }
};

Extent extent_between(const TileMesh& mesh, const std::array<std::int32_t, 3>& corners, double top, double bottom) {
  Extent extent;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int32_t a = corners[i], b = corners[(i + 1) % 3];
    const double ax = mesh.x[a], ay = mesh.y[a], bx = mesh.x[b], by = mesh.y[b];
    if (ay >= top && ay <= bottom) extent.add(ax);
    for (const double y : {top, bottom})
      if ((ay < y) != (by < y)) extent.add(ax + (bx - ax) * (y - ay) / (by - ay));
  }
  return extent;
}

/// Calls body(row, column) for the cells, those on the sides of the tile included, within `aside` units of the triangle, along x and y.
template <class Body>
void for_each_cell_near(const TileMesh& mesh, const TileCells& cells, const std::array<std::int32_t, 3>& corners, double aside, Body&& body) {
  const auto [low, high] = std::minmax({mesh.y[corners[0]], mesh.y[corners[1]], mesh.y[corners[2]]});
  const double units = mesh.units, reach = aside + near * units;
  const auto first_from = [&](double at) { return std::max(0, static_cast<std::int32_t>(std::ceil(at / units))); };
  const auto last_to = [&](double at, std::int64_t count) { return std::min(static_cast<std::int32_t>(count) - 1, static_cast<std::int32_t>(std::floor(at / units))); };
  for (std::int32_t row = first_from(low - reach), bottom = last_to(high + reach, cells.height); row <= bottom; ++row) {
    const Extent extent = extent_between(mesh, corners, row * units - reach, row * units + reach);
    for (std::int32_t column = first_from(extent.low - reach), right = last_to(extent.high + reach, cells.width); column <= right; ++column) body(row, column);
  }
}

Raster<std::uint8_t> find_covered(const TileMesh& mesh, const TileCells& cells) {
  Raster<std::uint8_t> covered(cells.width, cells.height, 0);
  for (std::int32_t t = 0; t < mesh.triangles(); ++t)
    for_each_cell_near(mesh, cells, mesh.corners(t), 0, [&](std::int32_t row, std::int32_t column) { covered(column, row) = 1; });
  return covered;
}

}  // namespace

std::vector<DisplacedExcess> find_displaced_excesses(const TileMesh& mesh, const TileCells& cells, const TileBound& bound) {
  Raster<std::uint8_t> covered;
  if (mesh.units != 2) covered = find_covered(mesh, cells);
  std::vector<DisplacedExcess> found;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    const std::array<std::int32_t, 3> corners = mesh.corners(t);
    const auto [a, b, c] = corners;
    const TrianglePlane plane = plane_of(mesh, a, b, c);
    const double allowed = allowance(mesh, plane, a, b, c, bound);
    DisplacedExcess worst{t};
    for_each_cell_near(mesh, cells, corners, moves_aside(mesh, a, b, c, bound), [&](std::int32_t row, std::int32_t column) {
      const float cell = cells(column, row);
      if (is_void(cell) || (mesh.units != 2 && !covered(column, row))) return;
      const double height = plane.height + plane.along_y * (row * mesh.units - mesh.y[a]) + plane.along_x * (column * mesh.units - mesh.x[a]);
      const double beyond = std::abs(height - plane.area2 * cell) - allowed;
      if (beyond <= worst.beyond_m) return;
      worst.beyond_m = beyond;
      worst.on_side = row == 0 || column == 0 || row + 1 == cells.height || column + 1 == cells.width;
    });
    worst.beyond_m /= plane.area2;
    if (worst.beyond_m > 0) found.push_back(worst);
  }
  return found;
}

}  // namespace arete
