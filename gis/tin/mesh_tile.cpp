#include "gis/tin/mesh_tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "gis/tin/greedy_insertion.h"
#include "gis/tin/heights.h"
#include "gis/tin/simplify.h"
#include "gis/tin/split_worst.h"
#include "gis/tin/triangle_errors.h"

namespace arete {

double short_bound(double error_m) {
  int exponent = 0;
  const double mantissa = std::frexp(error_m, &exponent);
  return std::ldexp(std::floor(std::ldexp(mantissa, 28)), exponent - 28);
}

namespace {

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

/// What the border keeps of the bound where triangles are displaced: the slopes beside it are not known yet.
double line_reserve(const TileOptions& options) { return options.displacement.any() ? options.max_error_m / 16 : 0; }

std::vector<Polyline> simplify_side(RasterView<const float> given, RasterView<const float> rounded, bool column, std::int64_t index,
                                    const TileOptions& options) {
  const double error_m = options.side_error_m > 0 ? options.side_error_m : options.max_error_m;
  const LineBound bound{bound_for(line_of(given, column, index), error_m - line_reserve(options)), options.height_step_m, 2,
                        options.displacement.longest_cells};
  return simplify_line(line_of(rounded, column, index), bound);
}

void add_error(TileErrors& errors, double error) {
  errors.max_error_m = std::max(errors.max_error_m, std::abs(error));
  errors.squares += error * error;
  ++errors.cells;
}

void measure_lines(const std::vector<Polyline>& lines, std::span<const float> cells, std::int32_t first, std::int32_t end, TileErrors& errors) {
  constexpr std::int32_t units = 2;
  for (const Polyline& line : lines)
    for (std::int32_t cell = std::max(first, (line.front().at + units - 1) / units); cell < end && cell * units <= line.back().at; ++cell)
      add_error(errors, height_at(line, cell * units) - cells[cell]);
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

/// Every cell once, against the cells as they were given.
TileErrors measure(const TileMesh& mesh, RasterView<const float> cells, const TileBorder& border, bool last_column, bool last_row) {
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
  const auto width = static_cast<std::int32_t>(cells.width), height = static_cast<std::int32_t>(cells.height);
  measure_lines(border.top, line_of(cells, false, 0), 0, last_column ? width : width - 1, errors);
  measure_lines(border.left, line_of(cells, true, 0), 1, last_row ? height : height - 1, errors);
  if (last_row) measure_lines(border.bottom, line_of(cells, false, height - 1), 1, last_column ? width : width - 1, errors);
  if (last_column) measure_lines(border.right, line_of(cells, true, width - 1), 1, height - 1, errors);
  errors.full_triangles = count_full_triangles(cells);
  return errors;
}

/// The triangle in or on which a place lies; -1: none.
std::int32_t find_triangle(const TileMesh& mesh, std::int32_t vertex) {
  for (std::int32_t t = 0; t < mesh.triangles(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    if (orientation(mesh, a, b, vertex) >= 0 && orientation(mesh, b, c, vertex) >= 0 && orientation(mesh, c, a, vertex) >= 0) return t;
  }
  return -1;
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
    const std::int32_t triangle = find_triangle(mesh_, vertex);
    std::vector<std::int32_t> changed;
    insert_vertex(mesh_, triangle, vertex, changed);
  }

  TileMesh& mesh_;
  const TileCells& cells_;
  double step_;
  std::map<Place, std::int32_t> numbers_;
};

}  // namespace

MeshedTile mesh_tile(RasterView<const float> given, const TileOptions& options, bool last_column, bool last_row) {
  const Raster<float> rounded = round_cells(given);
  const TileCells cells = rounded.view();
  const TileBorder border{simplify_side(given, cells, false, 0, options), simplify_side(given, cells, false, cells.height - 1, options),
                          simplify_side(given, cells, true, 0, options), simplify_side(given, cells, true, cells.width - 1, options)};
  MeshedTile tile;
  tile.mesh = triangulate_domain(cells, border, options.height_step_m);
  if (tile.mesh.origin.empty()) return tile;
  const TileBound bound{bound_for({given.data, static_cast<std::size_t>(given.stride * given.height)}, options.max_error_m), options.height_step_m,
                        options.displacement};
  tile.mesh = sort_mesh(tile.mesh);
  tile.mesh.leaving.clear();
  if (!options.squares.empty()) SquareKeeper(tile.mesh, cells, options.height_step_m).keep(options.squares);
  insert_greedily(tile.mesh, cells, bound);
  link_vertices(tile.mesh);
  simplify(tile.mesh, cells, bound, options.passes);
  tile.mesh = sort_mesh(tile.mesh);
  if (options.extra_share > 0) {
    split_worst(tile.mesh, cells, bound, static_cast<std::int64_t>(options.extra_share * tile.mesh.triangles() / 2));
    link_vertices(tile.mesh);
    tile.mesh = sort_mesh(tile.mesh);
  }
  tile.errors = measure(tile.mesh, given, border, last_column, last_row);
  return tile;
}

}  // namespace arete
