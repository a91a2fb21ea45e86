#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// Calls body(row, first, last) for the cells of each row whose centres lie in the closed triangle, the outer rows and columns of
/// the tile left out. A centre within 1e-7 of a cell from an edge counts for both sides: none is ever left out by both. Along rows in
/// meshes of half cells, whose vertices files keep; from the edge itself in others, whose vertices a file may move by its noise.
template <class Body>
void for_each_span(const TileMesh& mesh, const TileCells& cells, std::int32_t a, std::int32_t b, std::int32_t c, Body&& body) {
  double x0 = mesh.x[a], x1 = mesh.x[b], x2 = mesh.x[c];
  std::int32_t y0 = mesh.y[a], y1 = mesh.y[b], y2 = mesh.y[c];
  if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
  if (y1 > y2) std::swap(x1, x2), std::swap(y1, y2);
  if (y0 > y1) std::swap(x0, x1), std::swap(y0, y1);
  const std::int32_t units = mesh.units;
  const std::int32_t top = std::max<std::int32_t>(1, (y0 + units - 1) / units);
  const std::int32_t bottom = std::min(static_cast<std::int32_t>(cells.height) - 2, y2 / units);
  if (top > bottom) return;
  const std::int32_t right_end = static_cast<std::int32_t>(cells.width) - 2;
  const double cell = 1.0 / units;
  const double long_slope = (x2 - x0) / (y2 - y0);
  const double upper_slope = y1 > y0 ? (x1 - x0) / (y1 - y0) : 0, lower_slope = y2 > y1 ? (x2 - x1) / (y2 - y1) : 0;
  constexpr double near = 1e-7;
  const double noise = units == 2 ? 0 : near;
  const double long_near = near + noise * std::abs(long_slope);
  const double upper_near = near + noise * std::abs(upper_slope), lower_near = near + noise * std::abs(lower_slope);
  for (std::int32_t row = top; row <= bottom; ++row) {
    const std::int32_t y = row * units;
    double left = x0 + long_slope * (y - y0);
    double right = y < y1 ? x0 + upper_slope * (y - y0) : x1 + lower_slope * (y - y1);
    double left_near = long_near, right_near = y < y1 ? upper_near : lower_near;
    if (left > right) std::swap(left, right), std::swap(left_near, right_near);
    if (units != 2) {
      left_near = std::min(left_near, (left - std::min({x0, x1, x2})) * cell + near);
      right_near = std::min(right_near, (std::max({x0, x1, x2}) - right) * cell + near);
    }
    const std::int32_t first = std::max(1, static_cast<std::int32_t>(left * cell + (1 - left_near)));
    const std::int32_t last = std::min(right_end, static_cast<std::int32_t>(right * cell + right_near));
    if (first <= last) body(row, first, last);
  }
}

/// The plane through three vertices times twice the area of their triangle, about the first vertex:
/// area2 z(x, y) = area2 z(a) + along_x (x - x(a)) + along_y (y - y(a)). Exact in meshes of half cells: whole numbers times the height
/// step.
struct TrianglePlane {
  double area2, height, along_x, along_y;
  double noise;  ///< at most so much do heights times area2 lack, in meshes of finer units
};

/// With the unit roundoff u = 2^-53, the longest side L along x or y, the largest height Z and difference of heights D: along_x and
/// along_y lack at most 4 u D L, their products with distances up to 2 L at most 12 u D L^2 each, four sums and three products of
/// area2 and heights the rest. All taken twice, so that heights of cells beyond Z, which keep no bound, need no thought.
inline double plane_noise(double area2, double height, double difference, double length) {
  return 0x1p-53 * (16 * area2 * height + 64 * difference * length * length);
}

inline TrianglePlane plane_of(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c) {
  const double bx = mesh.x[b] - mesh.x[a], by = mesh.y[b] - mesh.y[a], cx = mesh.x[c] - mesh.x[a], cy = mesh.y[c] - mesh.y[a];
  const double bz = mesh.z[b] - mesh.z[a], cz = mesh.z[c] - mesh.z[a];
  if (mesh.units == 2) {
    const double area2 = bx * cy - by * cx;
    return {area2, area2 * mesh.z[a], bz * cy - cz * by, cz * bx - bz * cx, 0};
  }
  const double area2 = static_cast<double>(orientation(mesh, a, b, c)), difference = std::max(std::abs(bz), std::abs(cz));
  const double length = std::max({std::abs(bx), std::abs(by), std::abs(cx), std::abs(cy)});
  return {area2, area2 * mesh.z[a], bz * cy - cz * by, cz * bx - bz * cx, plane_noise(area2, std::abs(mesh.z[a]) + difference + 1, difference, length)};
}

/// The square of the longest edge, in square units.
inline double longest_squared(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c) {
  const auto squared = [&](std::int32_t from, std::int32_t to) {
    const double dx = mesh.x[to] - mesh.x[from], dy = mesh.y[to] - mesh.y[from];
    return dx * dx + dy * dy;
  };
  return std::max({squared(a, b), squared(b, c), squared(c, a)});
}

/// Whether an edge of the triangle is longer than any may be.
inline bool is_too_long(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, const TileBound& bound) {
  if (bound.displacement.longest_cells == any_length) return false;
  const double most = bound.displacement.longest_cells * mesh.units;
  return longest_squared(mesh, a, b, c) > most * most;
}

/// How far the triangle's sides and corners are moved along x and y, at most, in units.
inline double moves_aside(const TileMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, const TileBound& bound) {
  const Displacement& moved = bound.displacement;
  const double cells2 = longest_squared(mesh, a, b, c) / (static_cast<double>(mesh.units) * mesh.units);
  return (moved.rounding_cells + bound.noise_cells + moved.bend_cells * cells2) * mesh.units;
}

/// How much of the bound a triangle has for its cells, times twice its area: what its slope makes of the displacement is kept in
/// reserve.
inline double allowance(const TileMesh& mesh, const TrianglePlane& plane, std::int32_t a, std::int32_t b, std::int32_t c, const TileBound& bound) {
  const Displacement& moved = bound.displacement;
  if (!moved.any() && bound.noise_cells == 0) return plane.area2 * bound.error_m;
  const double sag_m = moved.sag_m * longest_squared(mesh, a, b, c) / (static_cast<double>(mesh.units) * mesh.units);
  return plane.area2 * (bound.error_m - sag_m) - moves_aside(mesh, a, b, c, bound) * (std::abs(plane.along_x) + std::abs(plane.along_y)) - plane.noise;
}

/// Calls body(difference, row, column) for each cell of a triangle: twice its area times the height of its plane over the cell.
template <class Body>
void for_each_difference(const TileMesh& mesh, const TileCells& cells, std::int32_t a, std::int32_t b, std::int32_t c,
                         const TrianglePlane& plane, Body&& body) {
  const double step = plane.along_x * mesh.units;
  for_each_span(mesh, cells, a, b, c, [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    const float* heights = cells.row(row);
    double height = plane.height + plane.along_y * (row * mesh.units - mesh.y[a]) + plane.along_x * (first * mesh.units - mesh.x[a]);
    if (mesh.units == 2) {
      for (std::int32_t column = first; column <= last; ++column, height += step) body(height - plane.area2 * heights[column], row, column);
    } else {
      for (std::int32_t column = first; column <= last; ++column) body(height + step * (column - first) - plane.area2 * heights[column], row, column);
    }
  });
}

/// The cell of a triangle that is furthest beyond the bound.
struct WorstCell {
  double difference = -1;  ///< twice the area of the triangle times metres; below 0: every cell keeps the bound
  std::int32_t row = 0, column = 0;
};

/// In meshes of finer units than half cells, and for formats that keep them: the reserves of slopes and rounding are not for corners at
/// centres of cells, which stay where they are.
inline WorstCell worst_beyond(const TileMesh& mesh, const TileCells& cells, std::int32_t a, std::int32_t b, std::int32_t c, const TrianglePlane& plane,
                              const TileBound& bound) {
  const double limit = allowance(mesh, plane, a, b, c, bound);
  WorstCell worst;
  for_each_difference(mesh, cells, a, b, c, plane, [&](double difference, std::int32_t row, std::int32_t column) {
    double size = std::abs(difference);
    if (size <= limit || std::isnan(size)) return;
    for (const std::int32_t v : {a, b, c})
      if (!bound.displacement.any() && mesh.x[v] == column * mesh.units && mesh.y[v] == row * mesh.units) {
        const double error = std::abs(mesh.z[v] - cells(column, row));
        if (error <= bound.error_m) return;
        size = error * plane.area2;
      }
    if (size > worst.difference) worst = {size, row, column};
  });
  return worst;
}

/// Whether every cell of the triangle keeps the bound, exactly; and the sum of its squared errors, m².
struct TriangleFit {
  bool keeps = true;
  double squares = 0;
};

inline TriangleFit fit_of(const TileMesh& mesh, const TileCells& cells, std::int32_t a, std::int32_t b, std::int32_t c, const TileBound& bound) {
  const TrianglePlane plane = plane_of(mesh, a, b, c);
  double worst = 0, squares = 0;
  for_each_difference(mesh, cells, a, b, c, plane, [&](double difference, std::int32_t, std::int32_t) {
    worst = std::max(worst, std::abs(difference));
    squares += difference * difference;
  });
  const bool keeps =
      worst <= allowance(mesh, plane, a, b, c, bound) || (mesh.units != 2 && worst_beyond(mesh, cells, a, b, c, plane, bound).difference < 0);
  return {keeps, squares / (plane.area2 * plane.area2)};
}

}  // namespace arete
