#include "gis/tin/terrain_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr int points = terrain_grid_cells + 1;
constexpr int most_levels = 24;

/// Longitudes and latitudes of a level's points, and back. Points are counted from 180 W and from the south pole.
double degrees_of(std::int64_t index, int level) { return std::ldexp(static_cast<double>(index) * 180 / terrain_grid_cells, -level); }
double index_of(double degrees, int level) { return std::ldexp(degrees * terrain_grid_cells / 180, level); }

/// A window of the raster with where its cells lie on a level's grid.
struct PlacedCells {
  Window window;
  std::vector<GlobePlace> places;  // heights in metres, NaN void
  const GlobePlace& at(std::int64_t column, std::int64_t row) const {
    return places[static_cast<std::size_t>((row - window.y) * window.width + column - window.x)];
  }
  bool has(std::int64_t column, std::int64_t row) const {
    return column >= window.x && row >= window.y && column < window.x + window.width && row < window.y + window.height;
  }
  double height(std::int64_t column, std::int64_t row) const { return has(column, row) ? at(column, row).height_m : std::nan(""); }
};

/// Where the points of a tile's grid lie in the raster, from the north-western corner.
std::vector<CellPlace> grid_in_cells(const GlobePlacement& placement, const TerrainTileId& tile) {
  std::vector<GlobePlace> globe;
  globe.reserve(points * points);
  for (int row = 0; row < points; ++row)
    for (int column = 0; column < points; ++column)
      globe.push_back({degrees_of(tile.x * terrain_grid_cells + column, tile.level) - 180,
                       degrees_of((tile.y + 1) * terrain_grid_cells - row, tile.level) - 90, 0});
  std::vector<CellPlace> cells(globe.size());
  placement.to_cells(globe, cells);
  return cells;
}

/// The cells that have a say in the grid: three more on each side.
std::optional<Window> window_of(const std::vector<CellPlace>& grid, Size size) {
  double left = std::numeric_limits<double>::infinity(), right = -left, top = left, bottom = -left;
  for (const CellPlace& place : grid) {
    if (!std::isfinite(place.column) || !std::isfinite(place.row)) continue;
    left = std::min(left, place.column), right = std::max(right, place.column);
    top = std::min(top, place.row), bottom = std::max(bottom, place.row);
  }
  const double width = static_cast<double>(size.width), height = static_cast<double>(size.height);
  if (!(left < width && right > -1 && top < height && bottom > -1)) return std::nullopt;
  constexpr double margin = 3;
  const auto x0 = static_cast<std::int64_t>(std::max(0.0, std::floor(left) - margin)), y0 = static_cast<std::int64_t>(std::max(0.0, std::floor(top) - margin));
  const auto x1 = static_cast<std::int64_t>(std::min(width - 1, std::ceil(right) + margin));
  const auto y1 = static_cast<std::int64_t>(std::min(height - 1, std::ceil(bottom) + margin));
  return Window{x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

PlacedCells place_cells(const RasterSource& raster, const GlobePlacement& placement, const Window& window) {
  Raster<float> heights(window.width, window.height);
  raster.read(window, heights.view());
  std::vector<CellPlace> cells;
  cells.reserve(static_cast<std::size_t>(window.size().cells()));
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      cells.push_back({static_cast<double>(window.x + x), static_cast<double>(window.y + y), static_cast<double>(heights(x, y))});
  PlacedCells placed{window, std::vector<GlobePlace>(cells.size())};
  placement.to_globe(cells, placed.places);
  return placed;
}

/// How the surface rises along a line of three elevations, the outer ones NaN where there is none.
double slope_of(double before, double here, double after) {
  if (std::isnan(before) && std::isnan(after)) return 0;
  if (std::isnan(before)) return after - here;
  if (std::isnan(after)) return here - before;
  return (after - before) / 2;
}

/// Bilinear; void neighbours have the elevation of the cell that the place lies in.
float interpolate(const PlacedCells& cells, const CellPlace& place) {
  if (!std::isfinite(place.column) || !std::isfinite(place.row) || std::abs(place.column) > 1e15 || std::abs(place.row) > 1e15) return void_value;
  const double own = cells.height(static_cast<std::int64_t>(std::floor(place.column + 0.5)), static_cast<std::int64_t>(std::floor(place.row + 0.5)));
  if (std::isnan(own)) return void_value;
  const auto column = static_cast<std::int64_t>(std::floor(place.column)), row = static_cast<std::int64_t>(std::floor(place.row));
  const double x = place.column - static_cast<double>(column), y = place.row - static_cast<double>(row);
  const auto height = [&](std::int64_t dx, std::int64_t dy) {
    const double h = cells.height(column + dx, row + dy);
    return std::isnan(h) ? own : h;
  };
  return static_cast<float>((height(0, 0) * (1 - x) + height(1, 0) * x) * (1 - y) + (height(0, 1) * (1 - x) + height(1, 1) * x) * y);
}

/// The grid of one tile while it is filled.
class GridFiller {
 public:
  GridFiller(const TerrainTileId& tile, const std::vector<CellPlace>& grid, const PlacedCells& cells, TerrainGrid& out)
      : tile_(tile), grid_(grid), cells_(cells), out_(out), settled_(points * points) {}

  /// The four points about a centre lie in the plane through its elevation.
  void settle(std::int64_t column, std::int64_t row) {
    const GlobePlace& place = cells_.at(column, row);
    const double x = index_of(place.longitude + 180, tile_.level) - static_cast<double>(tile_.x * terrain_grid_cells);
    const double y = index_of(place.latitude + 90, tile_.level) - static_cast<double>(tile_.y * terrain_grid_cells);
    if (!(x >= -1 && y >= -1 && x <= points && y <= points)) return;
    if (x >= 0 && y >= 0 && x <= terrain_grid_cells && y <= terrain_grid_cells)
      out_.centres.push_back({x * quantized_per_cell, y * quantized_per_cell, place.height_m});
    const double h = place.height_m;
    const double along_column = slope_of(cells_.height(column - 1, row), h, cells_.height(column + 1, row));
    const double along_row = slope_of(cells_.height(column, row - 1), h, cells_.height(column, row + 1));
    for (const int dy : {0, 1})
      for (const int dx : {0, 1}) {
        const int i = static_cast<int>(std::floor(x)) + dx, j = terrain_grid_cells - static_cast<int>(std::floor(y)) - dy;
        if (i < 0 || j < 0 || i >= points || j >= points) continue;
        const std::size_t at = static_cast<std::size_t>(j * points + i);
        if (settled_[at]) continue;
        settled_[at] = 1;
        const double height = h + along_column * (grid_[at].column - static_cast<double>(column)) + along_row * (grid_[at].row - static_cast<double>(row));
        out_.heights(i, j) = std::isfinite(height) ? static_cast<float>(height) : void_value;
      }
  }

  void interpolate_rest() {
    for (std::size_t at = 0; at < settled_.size(); ++at)
      if (!settled_[at]) out_.heights.data()[at] = interpolate(cells_, grid_[at]);
  }

 private:
  const TerrainTileId& tile_;
  const std::vector<CellPlace>& grid_;
  const PlacedCells& cells_;
  TerrainGrid& out_;
  std::vector<std::uint8_t> settled_;
};

/// Places along the border of the raster and in its middle.
std::vector<CellPlace> places_of(Size size) {
  constexpr int steps = 64;
  const double right = static_cast<double>(size.width) - 0.5, bottom = static_cast<double>(size.height) - 0.5;
  std::vector<CellPlace> places{{(right - 0.5) / 2, (bottom - 0.5) / 2, 0}};
  for (int i = 0; i <= steps; ++i) {
    const double x = -0.5 + (right + 0.5) * i / steps, y = -0.5 + (bottom + 0.5) * i / steps;
    for (const CellPlace& place : {CellPlace{x, -0.5, 0}, {x, bottom, 0}, {-0.5, y, 0}, {right, y, 0}}) places.push_back(place);
  }
  return places;
}

/// The least distance of a centre from its neighbours, in degrees along longitude or latitude, whichever is larger.
double least_distance(const GlobePlacement& placement, const std::vector<CellPlace>& places) {
  std::vector<CellPlace> around;
  for (const CellPlace& p : places)
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}, {1, -1}}) around.push_back({p.column + dx, p.row + dy, 0});
  std::vector<GlobePlace> globe(around.size());
  placement.to_globe(around, globe);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < globe.size(); i += 5)
    for (std::size_t k = 1; k < 5; ++k) {
      const double distance = std::max(std::abs(globe[i + k].longitude - globe[i].longitude), std::abs(globe[i + k].latitude - globe[i].latitude));
      if (distance > 0) least = std::min(least, distance);
    }
  return least;
}

/// Whether a pole is a place inside the raster; in degrees it is a line.
bool covers_pole(const GlobePlacement& placement, Size size) {
  for (const double latitude : {90.0, -90.0}) {
    const std::array<GlobePlace, 2> pole{{{0, latitude, 0}, {90, latitude, 0}}};
    std::array<CellPlace, 2> cells;
    placement.to_cells(pole, cells);
    const CellPlace& c = cells[0];
    if (std::hypot(c.column - cells[1].column, c.row - cells[1].row) < 1e-3 && c.column > -0.5 && c.row > -0.5 &&
        c.column < static_cast<double>(size.width) - 0.5 && c.row < static_cast<double>(size.height) - 0.5)
      return true;
  }
  return false;
}

TileRectangle extent_of(const GlobePlacement& placement, const std::vector<CellPlace>& places) {
  std::vector<GlobePlace> globe(places.size());
  placement.to_globe(places, globe);
  TileRectangle extent{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const GlobePlace& place : globe) {
    if (!std::isfinite(place.longitude)) continue;
    extent.west = std::min(extent.west, place.longitude), extent.east = std::max(extent.east, place.longitude);
    extent.south = std::min(extent.south, place.latitude), extent.north = std::max(extent.north, place.latitude);
  }
  extent.south = std::max(extent.south, -90.0), extent.north = std::min(extent.north, 90.0);
  if (extent.east - extent.west >= 180) extent.west = std::max(extent.west, -180.0), extent.east = std::min(extent.east, 180.0);
  return extent;
}

}  // namespace

TerrainGrid TerrainSampler::sample(const TerrainTileId& tile) const {
  TerrainGrid out;
  const std::vector<CellPlace> grid = grid_in_cells(placement_, tile);
  const std::optional<Window> window = window_of(grid, raster_.size());
  if (!window) return out;
  const PlacedCells cells = place_cells(raster_, placement_, *window);
  out.heights = Raster<float>(points, points, void_value);
  GridFiller filler(tile, grid, cells, out);
  for (std::int64_t row = window->y; row < window->y + window->height; ++row)
    for (std::int64_t column = window->x; column < window->x + window->width; ++column) filler.settle(column, row);
  filler.interpolate_rest();
  if (std::all_of(out.heights.data(), out.heights.data() + points * points, is_void)) out = {};
  return out;
}

TerrainTileRange deepest_terrain_level(const GlobePlacement& placement, Size size, TileRectangle& extent) {
  if (covers_pole(placement, size)) throw Error(ErrorKind::input, "the raster lies about a pole: Cesium's tiles end there; cut it in sectors (gdalwarp -te)");
  const std::vector<CellPlace> places = places_of(size);
  const double distance = least_distance(placement, places);
  extent = extent_of(placement, places);
  TerrainTileRange range;
  // A little more than two points: no rounding makes neighbours share one.
  while (range.level <= most_levels && 2.001 * degrees_of(1, range.level) > distance) ++range.level;
  if (range.level > most_levels || !std::isfinite(distance))
    throw Error(ErrorKind::input, "the cells of the raster are " + std::to_string(distance) + " degrees apart: no level of tiles up to 24 has so fine a grid");
  const auto tile_of = [&](double degrees, double off) {
    return static_cast<std::int64_t>(std::floor((index_of(degrees, range.level) + off) / terrain_grid_cells));
  };
  const std::int64_t rows = std::int64_t{1} << range.level;
  range.x0 = tile_of(extent.west + 180, -2), range.x1 = tile_of(extent.east + 180, 2);
  range.y0 = std::max<std::int64_t>(0, tile_of(extent.south + 90, -2)), range.y1 = std::min(rows - 1, tile_of(extent.north + 90, 2));
  if (extent.east - extent.west >= 180) range.x0 = std::max<std::int64_t>(0, range.x0), range.x1 = std::min(2 * rows - 1, range.x1);
  return range;
}

}  // namespace arete
