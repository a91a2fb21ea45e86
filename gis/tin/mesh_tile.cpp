#include "gis/tin/mesh_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/support/error.h"
#include "gis/tin/displaced_errors.h"
#include "gis/tin/greedy_insertion.h"
#include "gis/tin/heights.h"
#include "gis/tin/simplify.h"
#include "gis/tin/split_worst.h"
#include "gis/tin/triangle_errors.h"
#include "gis/tin/void_sides.h"

namespace arete {

double short_bound(double error_m) {
  int exponent = 0;
  const double mantissa = std::frexp(error_m, &exponent);
  return std::ldexp(std::floor(std::ldexp(mantissa, 28)), exponent - 28);
}

namespace {

// Doubles hold coordinates of 1e7 m to 1e-9 m, cells are 1 m and more; what reads files rounds to 2^-30 cell.
constexpr double noise_cells = 0x1p-26;

/// The error that is left for the mesh where cells were rounded.
double bound_for(std::span<const float> cells, double max_error_m) {
  const bool rounded = std::any_of(cells.begin(), cells.end(), [](float h) { return h != static_cast<float>(round_height(h, cell_step_m)) && !is_void(h); });
  return short_bound(rounded ? max_error_m - cell_step_m / 2 : max_error_m);
}

Raster<float> round_cells(RasterView<const float> cells) {
  Raster<float> rounded(cells.width, cells.height);
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) rounded(x, y) = static_cast<float>(round_height(cells(x, y), cell_step_m));
  return rounded;
}

/// A row or a column of cells.
std::vector<float> line_of(RasterView<const float> cells, bool column, std::int64_t index) {
  std::vector<float> line(static_cast<std::size_t>(column ? cells.height : cells.width));
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = column ? cells(index, static_cast<std::int64_t>(i)) : cells(static_cast<std::int64_t>(i), index);
  return line;
}

/// What is left of the bound on a side whose vertices georeferencing moves by the noise: no part of it is steeper than its range to half a cell.
double reserve(std::span<const float> cells, double error_m) {
  double low = 0, high = 0;
  bool any = false;
  for (const float h : cells) {
    if (is_void(h)) continue;
    low = any ? std::min<double>(low, h) : h, high = any ? std::max<double>(high, h) : h;
    any = true;
  }
  return error_m - 2 * noise_cells * (high - low + 2 * error_m);
}

std::vector<Polyline> simplify_side(RasterView<const float> given, RasterView<const float> rounded, bool column, std::int64_t index,
                                    const TileOptions& options, const std::vector<std::int32_t>* forced) {
  const double error_m = options.sides.error_m > 0 ? options.sides.error_m : options.max_error_m;
  const std::vector<float> line = line_of(rounded, column, index);
  LineBound bound{bound_for(line_of(given, column, index), error_m), options.height_step_m, 2,
                  std::min(options.displacement.longest_cells, options.sides.longest_cells)};
  if (forced == nullptr) return simplify_line(line, bound);
  bound.error_m = short_bound(reserve(line, bound.error_m));
  bound.units = line_units;
  return simplify_line(line, bound, *forced);
}

TileBorder simplify_sides(RasterView<const float> given, const TileCells& cells, const TileOptions& options, const DomainLines* lines) {
  const TileLines* places = lines != nullptr ? &lines->lines : nullptr;
  return {simplify_side(given, cells, false, 0, options, places ? &places->top : nullptr),
          simplify_side(given, cells, false, cells.height - 1, options, places ? &places->bottom : nullptr),
          simplify_side(given, cells, true, 0, options, places ? &places->left : nullptr),
          simplify_side(given, cells, true, cells.width - 1, options, places ? &places->right : nullptr)};
}

void add_error(TileErrors& errors, double error) {
  errors.max_error_m = std::max(errors.max_error_m, std::abs(error));
  errors.squares += error * error;
  ++errors.cells;
}

void measure_lines(const std::vector<Polyline>& lines, std::span<const float> cells, std::int32_t first, std::int32_t end, std::int32_t units,
                   TileErrors& errors) {
  for (const Polyline& line : lines)
    for (std::int32_t cell = std::max(first, (line.front().at + units - 1) / units); cell < end && cell * units <= line.back().at; ++cell)
      add_error(errors, height_at(line, cell * units) - cells[cell]);
}

/// Where triangles touch a line at `at` units, from and to, in units; ascending.
using Stretches = std::vector<std::array<std::int32_t, 2>>;

Stretches find_stretches(const TileMesh& mesh, bool column, std::int32_t at) {
  const std::vector<std::int32_t>&across = column ? mesh.x : mesh.y, &along = column ? mesh.y : mesh.x;
  Stretches stretches;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t from = mesh.origin[h], to = mesh.origin[next_edge(h)];
    if (across[from] != at) continue;
    stretches.push_back({along[from], along[from]});
    if (mesh.twin[h] < 0 && across[to] == at) stretches.push_back({std::min(along[from], along[to]), std::max(along[from], along[to])});
  }
  std::sort(stretches.begin(), stretches.end());
  return stretches;
}

bool lies_on(const Stretches& stretches, std::int32_t at) {
  const auto after = std::upper_bound(stretches.begin(), stretches.end(), at, [](std::int32_t place, const auto& stretch) { return place < stretch[0]; });
  return after != stretches.begin() && at <= (*(after - 1))[1];
}

/// The cells of a side that triangles touch.
void measure_side_cells(const TileMesh& mesh, const std::vector<Polyline>& lines, std::span<const float> cells, bool column, std::int32_t index, std::vector<SideCell>& found) {
  const std::int32_t units = mesh.units;
  const Stretches stretches = find_stretches(mesh, column, index * units);
  for (const Polyline& line : lines)
    for (std::int32_t cell = (line.front().at + units - 1) / units; cell < static_cast<std::int32_t>(cells.size()) && cell * units <= line.back().at; ++cell)
      if (lies_on(stretches, cell * units))
        found.push_back({column ? index : cell, column ? cell : index, height_at(line, cell * units) - cells[cell]});
}

std::int64_t count_full_triangles(RasterView<const float> cells) {
  std::int64_t count = 0;
  for (std::int64_t y = 0; y + 1 < cells.height; ++y)
    for (std::int64_t x = 0; x + 1 < cells.width; ++x) {
      const int valid = !is_void(cells(x, y)) + !is_void(cells(x + 1, y)) + !is_void(cells(x, y + 1)) + !is_void(cells(x + 1, y + 1));
      count += std::max(0, valid - 2);
    }
  return count;
}

/// Every cell inside the sides, against the cells as they were given.
TileErrors measure_inside(const TileMesh& mesh, RasterView<const float> cells) {
  TileErrors errors;
  Raster<float> off(cells.width, cells.height, void_value);
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const TrianglePlane plane = plane_of(mesh, a, b, c);
    for_each_difference(mesh, cells, a, b, c, plane, [&](double difference, std::int32_t row, std::int32_t column) {
      off(column, row) = static_cast<float>(difference / plane.area2);
      errors.max_error_m = std::max(errors.max_error_m, std::abs(difference / plane.area2));
    });
  }
  for (std::int64_t y = 1; y + 1 < cells.height; ++y)
    for (std::int64_t x = 1; x + 1 < cells.width; ++x)
      if (!is_void(off(x, y))) errors.squares += static_cast<double>(off(x, y)) * off(x, y), ++errors.cells;
  errors.full_triangles = count_full_triangles(cells);
  return errors;
}

void measure_sides(RasterView<const float> cells, const TileBorder& border, std::int32_t units, bool last_column, bool last_row, TileErrors& errors) {
  const auto width = static_cast<std::int32_t>(cells.width), height = static_cast<std::int32_t>(cells.height);
  measure_lines(border.top, line_of(cells, false, 0), 0, last_column ? width : width - 1, units, errors);
  measure_lines(border.left, line_of(cells, true, 0), 1, last_row ? height : height - 1, units, errors);
  if (last_row) measure_lines(border.bottom, line_of(cells, false, height - 1), 1, last_column ? width : width - 1, units, errors);
  if (last_column) measure_lines(border.right, line_of(cells, true, width - 1), 1, height - 1, units, errors);
}

std::vector<SideCell> find_side_cells(const TileMesh& mesh, RasterView<const float> cells, const TileBorder& border) {
  const auto right = static_cast<std::int32_t>(cells.width - 1), bottom = static_cast<std::int32_t>(cells.height - 1);
  std::vector<SideCell> found;
  measure_side_cells(mesh, border.top, line_of(cells, false, 0), false, 0, found);
  measure_side_cells(mesh, border.bottom, line_of(cells, false, bottom), false, bottom, found);
  measure_side_cells(mesh, border.left, line_of(cells, true, 0), true, 0, found);
  measure_side_cells(mesh, border.right, line_of(cells, true, right), true, right, found);
  return found;
}

/// Triangles must not turn over where vertices are moved by the noise, or by the rounding of a format.
void check_heights(const TileMesh& mesh, double rounding_cells) {
  const double least = 4 * std::max(noise_cells, rounding_cells) * mesh.units;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    double longest = 0;
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) longest = std::max(longest, std::hypot(mesh.x[to] - mesh.x[from], mesh.y[to] - mesh.y[from]));
    if (static_cast<double>(orientation(mesh, a, b, c)) < least * longest)
      throw Error(rounding_cells > noise_cells ? ErrorKind::format : ErrorKind::input,
                  "lines leave a triangle too thin for the coordinates of the mesh near column " + std::to_string(mesh.x[a] / mesh.units) + ", row " +
                      std::to_string(mesh.y[a] / mesh.units) + " of its tile: simplify the lines first");
  }
}

/// Makes the corners of the squares vertices, which are held.
class SquareKeeper {
 public:
  SquareKeeper(TileMesh& mesh, const TileCells& cells, double height_step_m) : mesh_(mesh), cells_(cells), step_(height_step_m) {
    for (std::int32_t v = 0; v < mesh.vertices(); ++v) numbers_[{mesh.x[v], mesh.y[v]}] = v;
  }

  void keep(std::span<const CellSquare> squares) {
    for (const CellSquare& s : squares)
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) insert(s.column + dx, s.row + dy);
    std::set<std::pair<Place, Place>> sides;
    for (const CellSquare& s : squares) {
      const std::array<Place, 4> corners{place_of(s.column, s.row), place_of(s.column + 1, s.row), place_of(s.column + 1, s.row + 1), place_of(s.column, s.row + 1)};
      for (std::size_t i = 0; i < 4; ++i) sides.insert({corners[i], corners[(i + 1) % 4]}), sides.insert({corners[(i + 1) % 4], corners[i]});
    }
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh_.origin.size()); ++h) {
      const std::int32_t a = mesh_.origin[h], b = mesh_.origin[next_edge(h)];
      if (sides.contains({{mesh_.x[a], mesh_.y[a]}, {mesh_.x[b], mesh_.y[b]}})) mesh_.fixed[h] = 1;
    }
  }

 private:
  using Place = std::pair<std::int32_t, std::int32_t>;
  Place place_of(std::int32_t column, std::int32_t row) const { return {column * mesh_.units, row * mesh_.units}; }

  void insert(std::int32_t column, std::int32_t row) {
    const Place place = place_of(column, row);
    if (column < 1 || row < 1 || column + 2 > cells_.width || row + 2 > cells_.height || is_void(cells_(column, row)) || numbers_.contains(place)) return;
    const std::int32_t vertex = add_vertex(mesh_, place.first, place.second, round_height(cells_(column, row), step_), true);
    numbers_[place] = vertex;
    std::vector<std::int32_t> changed;
    insert_vertex(mesh_, find_triangle(mesh_, last_, vertex), vertex, changed);
    last_ = changed.back();
  }

  TileMesh& mesh_;
  const TileCells& cells_;
  double step_;
  std::map<Place, std::int32_t> numbers_;
  std::int32_t last_ = 0;  // a triangle close by
};

/// Fills the sides of a tile with vertices and takes away what the bound does not need.
TileMesh fill(TileMesh mesh, const TileCells& cells, const TileBound& bound, const TileOptions& options) {
  insert_greedily(mesh, cells, bound);
  link_vertices(mesh);
  simplify(mesh, cells, bound, options.passes);
  mesh = sort_mesh(mesh);
  if (options.extra_share > 0) {
    split_worst(mesh, cells, bound, static_cast<std::int64_t>(options.extra_share * mesh.triangles() / 2));
    link_vertices(mesh);
    mesh = sort_mesh(mesh);
  }
  return mesh;
}

/// Splits the sides along voids of triangles, or close by, that are beyond the bound when displaced. Whether there was any.
bool split_void_sides(TileMesh& mesh, const TileCells& cells, const TileBound& bound, const std::vector<DisplacedExcess>& beyond) {
  std::vector<std::int32_t> changed;
  mesh.leaving.clear();
  for (const DisplacedExcess& excess : beyond) {
    VoidSide side = find_void_side(mesh, excess.triangle);
    if (side.edge < 0) side = find_void_side_about(mesh, excess.triangle);
    if (side.edge >= 0) split_void_side(mesh, cells, bound, side, changed);
  }
  if (!changed.empty()) insert_greedily(mesh, cells, bound);
  link_vertices(mesh);
  return !changed.empty();
}

/// The same so that the bound holds after the displacement. fill() proves it of the cells inside each triangle, not of those close beside it and on the sides of the
/// tile: where one of these is beyond it, sides along voids are split, and the tile is filled within less.
TileMesh fill_for_displacement(const TileMesh& mesh, const TileCells& cells, const TileBound& bound, const TileOptions& options) {
  TileBound inner = bound;
  for (double taken = 0; taken <= bound.error_m / 2;) {
    inner.error_m = short_bound(bound.error_m - taken);
    TileMesh filled = fill(mesh, cells, inner, options);
    std::vector<DisplacedExcess> beyond = find_displaced_excesses(filled, cells, bound);
    const bool sound = beyond.empty();
    while (!beyond.empty() && split_void_sides(filled, cells, inner, beyond)) beyond = find_displaced_excesses(filled, cells, bound);
    if (beyond.empty()) return sound ? filled : sort_mesh(filled);
    const auto worst = std::max_element(beyond.begin(), beyond.end(), [](const auto& a, const auto& b) { return a.beyond_m < b.beyond_m; });
    if (worst->on_side) break;
    taken = std::max({2 * taken, 1.5 * worst->beyond_m, bound.error_m / 64});
  }
  throw TooSteep();
}

}  // namespace

MeshedTile mesh_tile(RasterView<const float> given, const TileOptions& options, bool last_column, bool last_row, const DomainLines* lines) {
  const Raster<float> rounded = round_cells(given);
  const TileCells cells = rounded.view();
  const TileBorder border = simplify_sides(given, cells, options, lines);
  MeshedTile tile;
  tile.mesh = triangulate_domain(cells, border, options.height_step_m, lines, options.displacement.longest_cells);
  if (tile.mesh.origin.empty()) {
    tile.mesh = {};
    tile.errors.full_triangles = count_full_triangles(given);
    return tile;
  }
  const TileBound bound{bound_for({given.data, static_cast<std::size_t>(given.stride * given.height)}, options.max_error_m), options.height_step_m,
                        options.displacement, lines != nullptr ? noise_cells : 0};
  link_vertices(tile.mesh);
  tile.mesh = sort_mesh(tile.mesh);
  tile.mesh.leaving.clear();
  if (!options.squares.empty()) SquareKeeper(tile.mesh, cells, options.height_step_m).keep(options.squares);
  tile.mesh = bound.displacement.any() ? fill_for_displacement(tile.mesh, cells, bound, options) : fill(std::move(tile.mesh), cells, bound, options);
  if (lines != nullptr) check_heights(tile.mesh, options.displacement.rounding_cells);
  tile.errors = measure_inside(tile.mesh, given);
  if (lines != nullptr && lines->inside) tile.side_cells = find_side_cells(tile.mesh, given, border);
  else measure_sides(given, border, tile.mesh.units, last_column, last_row, tile.errors);
  return tile;
}

}  // namespace arete
