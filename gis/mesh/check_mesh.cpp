#include "gis/mesh/check_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "core/terrain/cell_store.h"
#include "gis/mesh/exact.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/raster_plane.h"
#include "gis/mesh/recent_blocks.h"
#include "gis/mesh/triangle_cells.h"

namespace arete {
namespace {

constexpr std::int64_t tile_side = 256;

/// What has been found of a cell.
enum CellState : std::uint8_t { covered = 1, inside = 2, folded = 4, too_far = 8, counted_void = 16 };

/// A square of the DEM, and what has been found of its cells.
struct Tile {
  Window window;
  Raster<float> elevations;
  Raster<std::uint8_t> states;
};

/// Tiles of a DEM; those that are not at hand keep their states in a store.
class Tiles {
 public:
  Tiles(const RasterSource& dem, const Scratch& scratch)
      : dem_(dem),
        across_((dem.size().width + tile_side - 1) / tile_side),
        down_((dem.size().height + tile_side - 1) / tile_side),
        states_(dem.size(), scratch, scratch.memory_bytes / 4),
        recent_(across_ * down_, std::max(across_ + 2, scratch.memory_bytes / 8 / (tile_side * tile_side * 5)),
                [this](std::int64_t index, Tile& tile) { load(index, tile); },
                [this](std::int64_t, const Tile& tile) { states_.write(tile.window, tile.states.view()); }) {}
  Tiles(const Tiles&) = delete;
  Tiles& operator=(const Tiles&) = delete;

  std::int64_t count() const { return across_ * down_; }
  Tile& at(std::int64_t index) { return recent_.at(index); }
  Tile& of_cell(std::int64_t column, std::int64_t row) { return recent_.at(row / tile_side * across_ + column / tile_side); }

 private:
  void load(std::int64_t index, Tile& tile) const {
    const std::int64_t x = index % across_ * tile_side, y = index / across_ * tile_side;
    tile.window = {x, y, std::min(tile_side, dem_.size().width - x), std::min(tile_side, dem_.size().height - y)};
    tile.elevations = Raster<float>(tile.window.width, tile.window.height);
    dem_.read(tile.window, tile.elevations.view());
    tile.states = states_.read(tile.window);
  }

  const RasterSource& dem_;
  std::int64_t across_, down_;
  CellStore<std::uint8_t> states_;
  RecentBlocks<Tile> recent_;
};

void add(CellFault& fault, std::int64_t column, std::int64_t row) {
  if (fault.count++ == 0 || std::pair(row, column) < std::pair(fault.row, fault.column)) fault.column = column, fault.row = row;
}

/// Compares triangles with the cells that they cover.
class CellChecker {
 public:
  CellChecker(Tiles& tiles, Size size, std::optional<double> bound, MeshErrors& errors) : tiles_(tiles), size_(size), bound_(bound), errors_(errors) {}

  /// Corners of positive twice_area.
  void check(const std::array<RasterPoint, 3>& corners) {
    const std::array<double, 3> heights = {corners[0].z, corners[1].z, corners[2].z};
    for_cells_in_triangle(corners, {0, 0, size_.width, size_.height}, [&](const auto& span) { check_span(span, heights); });
  }
  /// After every block of triangles: sums of few squares lose nothing.
  void end_block() { squares_ += std::exchange(block_squares_, 0); }
  double squares() const { return squares_; }

 private:
  template <class Int>
  void check_span(CellSpan<Int> span, const std::array<double, 3>& heights) {
    for (std::int64_t column = span.first; column <= span.last;) {
      Tile& tile = tiles_.of_cell(column, span.row);
      const std::int64_t row = span.row - tile.window.y, end = std::min(span.last + 1, tile.window.x + tile.window.width);
      for (; column < end; ++column) {
        check_cell(span, heights, column, tile.elevations(column - tile.window.x, row), tile.states(column - tile.window.x, row));
        for (std::size_t i = 0; i < 3; ++i) span.weights[i] += span.step[i];
      }
    }
  }

  template <class Int>
  void check_cell(const CellSpan<Int>& span, const std::array<double, 3>& heights, std::int64_t column, float elevation, std::uint8_t& state) {
    if (is_void(elevation)) {
      if (!(state & counted_void)) add(errors_.covered_voids, column, span.row);
      state |= counted_void;
      return;
    }
    const auto& w = span.weights;
    const bool within = w[0] > 0 && w[1] > 0 && w[2] > 0;
    if (!(state & folded) && ((state & inside) || (within && (state & covered)))) {
      add(errors_.folds, column, span.row);
      state |= folded;
    }
    const double error = measure(span, heights, column, static_cast<double>(elevation), state);
    if (error > errors_.max_error_m ||
        (error == errors_.max_error_m && std::pair(span.row, column) < std::pair(errors_.max_row, errors_.max_column)) || errors_.max_row < 0) {
      errors_.max_error_m = error;
      errors_.max_column = column;
      errors_.max_row = span.row;
    }
    if (!(state & covered)) {
      ++errors_.compared_cells;
      block_squares_ += error * error;
    }
    state = static_cast<std::uint8_t>(state | covered | (within ? inside : 0));
  }

  /// The error at a cell; counts it where it exceeds the bound. Doubles decide but where the error is as close to the bound as they round.
  template <class Int>
  double measure(const CellSpan<Int>& span, const std::array<double, 3>& heights, std::int64_t column, double elevation, std::uint8_t& state) {
    double sum = 0, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double part = static_cast<double>(span.weights[i]) * (heights[i] - elevation);
      sum += part;
      size += std::fabs(part);
    }
    const auto area = static_cast<double>(span.area);
    double error = std::fabs(sum) / area;
    if (!bound_) return error;
    const double bound = *bound_, over = std::fabs(sum) - bound * area;
    bool exceeds = over > 0;
    if (std::fabs(over) <= 16 * std::numeric_limits<double>::epsilon() * (size + bound * area)) {
      exceeds = exceeds_exactly(span, heights, elevation, bound);
      error = exceeds ? std::max(error, std::nextafter(bound, HUGE_VAL)) : std::min(error, bound);
    }
    if (exceeds && !(state & too_far)) {
      add(errors_.violations, column, span.row);
      state |= too_far;
    }
    return error;
  }

  template <class Int>
  static bool exceeds_exactly(const CellSpan<Int>& span, const std::array<double, 3>& heights, double elevation, double bound) {
    const auto& w = span.weights;
    const std::array<Int128, 5> weights = {w[0], w[1], w[2], -static_cast<Int128>(span.area), -static_cast<Int128>(span.area)};
    const std::array<double, 5> above = {heights[0], heights[1], heights[2], elevation, bound}, below = {heights[0], heights[1], heights[2], elevation, -bound};
    return exact_sign(weights, above) > 0 || exact_sign(weights, below) < 0;
  }

  Tiles& tiles_;
  Size size_;
  std::optional<double> bound_;
  MeshErrors& errors_;
  double squares_ = 0, block_squares_ = 0;
};

/// Every triangle by itself, and its cells. Returns twice the area of all, in units of 2^-60 cell.
Int128 check_triangles(const MeshSource& mesh, RasterPoints& points, int orientation, CellChecker& cells, MeshErrors& errors, Progress& progress) {
  Int128 total = 0;
  progress.begin("Comparing cells", mesh.triangles());
  for_triangle_blocks(mesh, [&](std::int64_t first, std::span<const MeshTriangle> triangles) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::int64_t index = first + static_cast<std::int64_t>(i);
      std::array<RasterPoint, 3> corners = corners_of(triangles[i], index, points);
      const Int128 area = twice_area(corners);
      if (area == 0) {
        errors.degenerate.add(index);
        continue;
      }
      if ((area > 0) != (orientation > 0)) errors.clockwise.add(index);
      if (area < 0) std::swap(corners[1], corners[2]);
      total += area > 0 ? area : -area;
      cells.check(corners);
    }
    cells.end_block();
    progress.advance(static_cast<std::int64_t>(triangles.size()));
  });
  progress.end();
  return total;
}

MeshFault find_outside(const RasterPoints& points, Size size) {
  MeshFault outside;
  std::vector<RasterPoint> block;
  for (std::int64_t first = 0; first < points.size(); first += mesh_block) {
    block.resize(static_cast<std::size_t>(std::min(mesh_block, points.size() - first)));
    points.read(first, block);
    for (std::size_t i = 0; i < block.size(); ++i)
      if (block[i].column < 0 || block[i].row < 0 || block[i].column > (size.width - 1) * cell_units || block[i].row > (size.height - 1) * cell_units)
        outside.add(first + static_cast<std::int64_t>(i));
  }
  return outside;
}

/// How many halves of a cell lie within the outermost centres, along one side.
std::int64_t halves(std::int64_t at, std::int64_t length) { return (at > 0) + (at + 1 < length); }

/// What no triangle shows: valid cells, their range, those that are not covered. Returns the area of the domain in quarters of a cell.
std::int64_t survey_cells(Tiles& tiles, Size size, MeshErrors& errors, Progress& progress) {
  std::int64_t quarters = 0;
  double low = HUGE_VAL, high = -HUGE_VAL;
  progress.begin("Counting cells", size.cells());
  for (std::int64_t index = 0; index < tiles.count(); ++index) {
    const Tile& tile = tiles.at(index);
    for (std::int64_t y = 0; y < tile.window.height; ++y)
      for (std::int64_t x = 0; x < tile.window.width; ++x) {
        const float elevation = tile.elevations(x, y);
        if (is_void(elevation)) continue;
        const std::int64_t column = tile.window.x + x, row = tile.window.y + y;
        ++errors.valid_cells;
        quarters += halves(column, size.width) * halves(row, size.height);
        low = std::min(low, static_cast<double>(elevation));
        high = std::max(high, static_cast<double>(elevation));
        if (!(tile.states(x, y) & covered)) add(errors.uncovered, column, row);
      }
    progress.advance(tile.window.size().cells());
  }
  progress.end();
  errors.cells = size.cells();
  errors.low_m = errors.valid_cells > 0 ? low : std::nan("");
  errors.high_m = errors.valid_cells > 0 ? high : std::nan("");
  return quarters;
}

void finish(MeshErrors& errors, double squares, const GeoReference& geo) {
  if (errors.compared_cells == 0) {
    errors.max_error_m = errors.rmse_m = errors.max_x = errors.max_y = std::nan("");
    return;
  }
  errors.rmse_m = std::sqrt(squares / static_cast<double>(errors.compared_cells));
  const auto t = geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1});
  const double column = static_cast<double>(errors.max_column) + 0.5, row = static_cast<double>(errors.max_row) + 0.5;
  errors.max_x = t[0] + column * t[1] + row * t[2];
  errors.max_y = t[3] + column * t[4] + row * t[5];
}

}  // namespace

double MeshErrors::psnr_db() const { return rmse_m > 0 ? 20 * std::log10((high_m - low_m) / rmse_m) : HUGE_VAL; }

MeshErrors check_mesh(const MeshSource& mesh, const MeshFrame& frame, const RasterSource& dem, const GeoReference& geo, const MeshCheckOptions& options,
                      Progress& progress) {
  MeshErrors errors;
  errors.vertices = mesh.vertices();
  errors.triangles = mesh.triangles();
  const std::int64_t memory = options.scratch.memory_bytes;
  const Size size = dem.size();
  const RasterPlane plane(frame, geo, options.snap_cells);
  RasterPoints points(mesh, plane, options.scratch, memory / 4, progress);
  errors.outside = find_outside(points, size);
  {
    Tiles tiles(dem, options.scratch);
    CellChecker cells(tiles, size, options.max_error_m, errors);
    const Int128 area = check_triangles(mesh, points, plane.orientation(), cells, errors, progress);
    // Twice a cell is 2^61 square units, a quarter of it 2^59.
    const Int128 domain = static_cast<Int128>(survey_cells(tiles, size, errors, progress)) << 59;
    errors.area_sign = area > domain ? 1 : area < domain ? -1 : 0;
    errors.area_cells = std::ldexp(static_cast<double>(area), -61);
    errors.domain_cells = std::ldexp(static_cast<double>(domain), -61);
    finish(errors, cells.squares(), geo);
  }
  std::vector<BorderEdge> border;
  errors.topology = mesh_topology(mesh, memory / 2, progress, &border);
  errors.t_junctions = find_t_junctions(border, points);
  errors.cracks = find_cracks(border, points);
  return errors;
}

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

}  // namespace

std::vector<std::string> faults_of(const MeshErrors& errors, const MeshCheckOptions& options) {
  std::vector<std::string> lines;
  const auto cells = [&](const CellFault& fault, const std::string& what) {
    if (fault.count > 0)
      lines.push_back(std::to_string(fault.count) + " cells " + what + ", first column " + std::to_string(fault.column) + ", row " + std::to_string(fault.row));
  };
  const auto parts = [&](const MeshFault& fault, const std::string& what) {
    if (fault.count > 0) lines.push_back(std::to_string(fault.count) + " " + what + ", first " + std::to_string(fault.first));
  };
  if (options.max_error_m) cells(errors.violations, "are further off than " + number(*options.max_error_m) + " m");
  if (!options.allow_uncovered) cells(errors.uncovered, "are valid and in no triangle");
  cells(errors.covered_voids, "are void and in a triangle");
  cells(errors.folds, "lie inside two triangles");
  parts(errors.outside, "vertices lie outside the DEM");
  parts(errors.degenerate, "triangles have no area");
  parts(errors.clockwise, "triangles are clockwise");
  if (errors.area_sign > 0 || (errors.area_sign < 0 && !options.allow_uncovered))
    lines.push_back("the triangles cover " + number(errors.area_cells) + " cells, the valid cells of the DEM " + number(errors.domain_cells));
  if (errors.topology.non_manifold_edges > 0) lines.push_back(std::to_string(errors.topology.non_manifold_edges) + " edges are not manifold");
  parts(errors.t_junctions, "vertices lie inside an edge of the border");
  parts(errors.cracks, "edges of the border lie on another's place: the mesh is cracked");
  return lines;
}

}  // namespace arete
