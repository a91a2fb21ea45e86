#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "gis/mesh/exact.h"
#include "gis/mesh/raster_plane.h"

namespace arete {

/// Part of a row of cells, and at its first cell the weights of the three corners: integers that are all >= 0 in or on the triangle, 0 on
/// the side that faces the corner, and add up to `area`. They grow by `step` from a cell to the next.
template <class Int>
struct CellSpan {
  std::int64_t row = 0, first = 0, last = 0;  // cells, both ends included
  std::array<Int, 3> weights{}, step{};
  Int area{};  // twice that of the triangle
};

/// Twice the area in columns and rows, in square units (2^-60 cell); negative where the corners run against that sense.
inline Int128 twice_area(const std::array<RasterPoint, 3>& p) {
  const Int128 ax = p[1].column - p[0].column, ay = p[1].row - p[0].row;
  return ax * (p[2].row - p[0].row) - ay * (p[2].column - p[0].column);
}

namespace triangle_cells {

template <class Int>
Int floor_div(Int a, Int b) {  // b > 0
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// Columns and rows of the corners, in `unit`s per cell, from a cell near them, so that numbers stay small.
template <class Int>
struct Corners {
  std::array<Int, 3> column, row;
  std::int64_t origin_column = 0, origin_row = 0;
  Int unit;
};

template <class Int, class Visit>
void visit_rows(const Corners<Int>& t, const Window& window, const Visit& visit) {
  const auto& x = t.column;
  const auto& y = t.row;
  std::array<Int, 3> across, down;  // how the weights grow from a cell to the next
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    across[i] = (y[j] - y[k]) * t.unit;
    down[i] = (x[k] - x[j]) * t.unit;
  }
  CellSpan<Int> span;
  span.step = across;
  span.area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  const auto [top, bottom] = std::minmax({y[0], y[1], y[2]});
  const auto first_row = std::max(static_cast<std::int64_t>(-floor_div<Int>(-top, t.unit)), window.y - t.origin_row);
  const auto last_row = std::min(static_cast<std::int64_t>(floor_div<Int>(bottom, t.unit)), window.y + window.height - 1 - t.origin_row);
  for (std::int64_t row = first_row; row <= last_row; ++row) {
    Int first = window.x - t.origin_column, last = window.x + window.width - 1 - t.origin_column;
    std::array<Int, 3> at_origin;  // the weights at column 0 of this row
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      at_origin[i] = (x[k] - x[j]) * (static_cast<Int>(row) * t.unit - y[j]) + (y[k] - y[j]) * x[j];
      if (across[i] > 0)
        first = std::max(first, -floor_div<Int>(at_origin[i], across[i]));
      else if (across[i] < 0)
        last = std::min(last, floor_div<Int>(at_origin[i], -across[i]));
      else if (at_origin[i] < 0)
        last = first - 1;
    }
    if (first > last) continue;
    for (std::size_t i = 0; i < 3; ++i) span.weights[i] = at_origin[i] + across[i] * first;
    span.row = row + t.origin_row;
    span.first = static_cast<std::int64_t>(first) + t.origin_column;
    span.last = static_cast<std::int64_t>(last) + t.origin_column;
    visit(span);
  }
}

template <class Int>
Corners<Int> corners(const std::array<RasterPoint, 3>& p, std::int64_t unit) {
  Corners<Int> t;
  t.unit = static_cast<Int>(unit);
  t.origin_column = std::min({p[0].column, p[1].column, p[2].column}) >> 30;
  t.origin_row = std::min({p[0].row, p[1].row, p[2].row}) >> 30;
  const std::int64_t shrink = cell_units / unit;
  for (std::size_t i = 0; i < 3; ++i) {
    t.column[i] = static_cast<Int>((p[i].column - t.origin_column * cell_units) / shrink);
    t.row[i] = static_cast<Int>((p[i].row - t.origin_row * cell_units) / shrink);
  }
  return t;
}

}  // namespace triangle_cells

/// Visits the cells of a window whose centres lie in or on a triangle of positive twice_area, row by row: visit(CellSpan<Int>) with Int
/// std::int64_t where all corners lie at multiples of half a cell (and less than 2^28 cells apart), else Int128. No rounding: a centre
/// on an edge is a cell of the triangles on both sides.
template <class Visit>
void for_cells_in_triangle(const std::array<RasterPoint, 3>& p, const Window& window, const Visit& visit) {
  std::int64_t bits = 0;
  for (const RasterPoint& point : p) bits |= point.column | point.row;
  const auto [left, right] = std::minmax({p[0].column, p[1].column, p[2].column});
  const auto [top, bottom] = std::minmax({p[0].row, p[1].row, p[2].row});
  constexpr std::int64_t half = cell_units / 2;
  if (bits % half == 0 && std::max(right - left, bottom - top) < cell_units << 28)
    triangle_cells::visit_rows(triangle_cells::corners<std::int64_t>(p, 2), window, visit);
  else
    triangle_cells::visit_rows(triangle_cells::corners<Int128>(p, cell_units), window, visit);
}

}  // namespace arete
