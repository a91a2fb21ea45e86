#include "gis/mesh/check_terrain_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "core/support/file.h"
#include "core/support/parallel.h"
#include "gis/globe_placement.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/terrain_tile_errors.h"

namespace arete {
namespace {

constexpr std::int64_t batch = 256;

struct Tile {
  int level = 0;
  std::int64_t x = 0, y = 0;
};

std::string name_of(const Tile& tile) { return std::to_string(tile.level) + "/" + std::to_string(tile.x) + "/" + std::to_string(tile.y); }

QuantizedMesh read_tile(const std::string& folder, const Tile& tile) {
  const std::string path = terrain_tile_path(folder, tile.level, tile.x, tile.y);
  return decode_quantized_mesh(read_file(path), path);
}

bool is_available(const TerrainLayer& layer, const Tile& tile) {
  const auto& blocks = layer.available[static_cast<std::size_t>(tile.level)];
  return std::any_of(blocks.begin(), blocks.end(), [&](const TerrainTileBlock& b) { return tile.x >= b.x0 && tile.x <= b.x1 && tile.y >= b.y0 && tile.y <= b.y1; });
}

/// Kinds of faults, how many of each and where first.
class Faults {
 public:
  void add(const std::string& kind, std::int64_t count, const std::string& place) {
    if (count <= 0) return;
    const auto [found, added] = kinds_.try_emplace(kind, std::pair{count, place});
    if (!added) found->second.first += count;
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const auto& [kind, what] : kinds_) lines.push_back(std::to_string(what.first) + " " + kind + ", first in " + what.second);
    return lines;
  }

 private:
  std::map<std::string, std::pair<std::int64_t, std::string>> kinds_;
};

/// The elevations of a DEM on tiles.
class Truth {
 public:
  explicit Truth(const TerrainTruth& dem) : raster_(dem.raster), placement_(dem.geo, dem.raster.size()) {
    const Size size = raster_.size();
    const std::array<CellPlace, 1> middle{{{static_cast<double>(size.width - 1) / 2, static_cast<double>(size.height - 1) / 2, 0}}};
    std::array<GlobePlace, 1> place;
    placement_.to_globe(middle, place);
    middle_ = place[0].longitude;
  }

  /// The cells whose centres lie on the tile, its eastern and northern side left out.
  std::vector<TerrainPoint> on(const Tile& tile) const {
    TileRectangle r = terrain_tile_rectangle(tile.level, tile.x, tile.y);
    const double turn = 360 * std::round((middle_ - (r.west + r.east) / 2) / 360);
    r.west += turn, r.east += turn;
    std::vector<TerrainPoint> points;
    const Window window = window_of(r);
    if (window.width <= 0 || window.height <= 0) return points;
    Raster<float> heights(window.width, window.height);
    raster_.read(window, heights.view());
    std::vector<CellPlace> cells;
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x)
        cells.push_back({static_cast<double>(window.x + x), static_cast<double>(window.y + y), static_cast<double>(heights(x, y))});
    std::vector<GlobePlace> globe(cells.size());
    placement_.to_globe(cells, globe);
    for (const GlobePlace& place : globe) {
      const TerrainPoint point{(place.longitude - r.west) / (r.east - r.west) * quantized_end, (place.latitude - r.south) / (r.north - r.south) * quantized_end,
                               place.height_m};
      if (point.u >= 0 && point.v >= 0 && point.u < quantized_end && point.v < quantized_end) points.push_back(point);
    }
    return points;
  }

  std::int64_t count_valid() const {
    const Size size = raster_.size();
    std::int64_t count = 0;
    for (std::int64_t y = 0; y < size.height; y += batch) {
      for (std::int64_t x = 0; x < size.width; x += 4 * batch) {
        const Window window{x, y, std::min(4 * batch, size.width - x), std::min(batch, size.height - y)};
        Raster<float> cells(window.width, window.height);
        raster_.read(window, cells.view());
        count += std::count_if(cells.data(), cells.data() + window.size().cells(), [](float h) { return !is_void(h); });
      }
    }
    return count;
  }

 private:
  /// A window about a lattice of places on the tile.
  Window window_of(const TileRectangle& r) const {
    constexpr int steps = 24;
    std::vector<GlobePlace> lattice;
    for (int j = 0; j <= steps; ++j)
      for (int i = 0; i <= steps; ++i) lattice.push_back({r.west + (r.east - r.west) * i / steps, r.south + (r.north - r.south) * j / steps, 0});
    std::vector<CellPlace> cells(lattice.size());
    placement_.to_cells(lattice, cells);
    double left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
    for (const CellPlace& c : cells) {
      if (!std::isfinite(c.column) || !std::isfinite(c.row)) continue;
      left = std::min(left, c.column), right = std::max(right, c.column), top = std::min(top, c.row), bottom = std::max(bottom, c.row);
    }
    const double across = static_cast<double>(raster_.size().width), down = static_cast<double>(raster_.size().height);
    if (!(left < across && right > -1 && top < down && bottom > -1)) return {};
    // Sides of tiles bend between the places of the lattice.
    const double margin = 2 + std::max(right - left, bottom - top) / 50;
    const auto first = [&](double at) { return static_cast<std::int64_t>(std::max(0.0, std::floor(at - margin))); };
    const auto last = [&](double at, double end) { return static_cast<std::int64_t>(std::min(end - 1, std::ceil(at + margin))); };
    return {first(left), first(top), last(right, across) - first(left) + 1, last(bottom, down) - first(top) + 1};
  }

  const RasterSource& raster_;
  GlobePlacement placement_;
  double middle_ = 0;
};

/// What one tile shows.
struct TileCheck {
  std::int64_t triangles = 0, vertices = 0, clockwise = 0, not_manifold = 0, gaps = 0, east_differs = 0, north_differs = 0;
  TerrainTileErrors cells;
  std::int64_t too_far = 0;
};

std::int64_t twice_area(const QuantizedMesh& mesh, std::size_t t) {
  const std::uint32_t a = mesh.triangles[t], b = mesh.triangles[t + 1], c = mesh.triangles[t + 2];
  const std::int64_t bx = mesh.u[b] - mesh.u[a], by = mesh.v[b] - mesh.v[a], cx = mesh.u[c] - mesh.u[a], cy = mesh.v[c] - mesh.v[a];
  return bx * cy - by * cx;
}

class TileChecker {
 public:
  TileChecker(const std::string& folder, const TerrainLayer& layer, const Truth* truth, std::optional<double> bound)
      : folder_(folder), layer_(layer), truth_(truth), bound_(bound) {}

  TileCheck check(const Tile& tile) const {
    const QuantizedMesh mesh = read_tile(folder_, tile);
    TileCheck found;
    found.triangles = static_cast<std::int64_t>(mesh.triangles.size() / 3);
    found.vertices = mesh.vertices();
    std::int64_t area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
      const std::int64_t part = twice_area(mesh, t);
      found.clockwise += part <= 0;
      area += part;
    }
    const TerrainTileEdges edges = find_tile_edges(mesh);
    found.not_manifold = edges.not_manifold;
    const bool deepest = tile.level + 1 == static_cast<int>(layer_.available.size());
    constexpr std::int64_t whole = std::int64_t{2} * quantized_end * quantized_end;
    if (!deepest || layer_.filled) found.gaps = edges.inner_borders + (area != whole);
    check_sides(tile, mesh, found);
    if (deepest && truth_ != nullptr) {
      found.cells = compare_terrain_tile(mesh, truth_->on(tile));
      if (bound_) found.too_far = std::count_if(found.cells.error_m.begin(), found.cells.error_m.end(), [&](double e) { return e > *bound_; });
      if (layer_.filled) found.cells.covered_voids = 0;
    }
    return found;
  }

 private:
  void check_sides(const Tile& tile, const QuantizedMesh& mesh, TileCheck& found) const {
    const Tile east{tile.level, (tile.x + 1) % (std::int64_t{2} << tile.level), tile.y}, north{tile.level, tile.x, tile.y + 1};
    if (is_available(layer_, east)) {
      const QuantizedMesh other = read_tile(folder_, east);
      found.east_differs = side_vertices(mesh, mesh.east, mesh.v) != side_vertices(other, other.west, other.v);
    }
    if (is_available(layer_, north)) {
      const QuantizedMesh other = read_tile(folder_, north);
      found.north_differs = side_vertices(mesh, mesh.north, mesh.u) != side_vertices(other, other.south, other.u);
    }
    found.not_manifold += lists_differ(mesh);
  }

  /// Whether the lists of the sides are not the vertices on them.
  static bool lists_differ(const QuantizedMesh& mesh) {
    QuantizedMesh again = mesh;
    place_quantized_mesh(again, {0, 0, 1, 1});
    for (const auto& [a, b] : {std::pair{&mesh.west, &again.west}, {&mesh.south, &again.south}, {&mesh.east, &again.east}, {&mesh.north, &again.north}}) {
      std::vector<std::uint32_t> stated = *a, found = *b;
      std::sort(stated.begin(), stated.end()), std::sort(found.begin(), found.end());
      if (stated != found) return true;
    }
    return false;
  }

  const std::string& folder_;
  const TerrainLayer& layer_;
  const Truth* truth_;
  std::optional<double> bound_;
};

std::vector<Tile> tiles_of(const TerrainLayer& layer) {
  std::vector<Tile> tiles;
  for (std::size_t level = 0; level < layer.available.size(); ++level)
    for (const TerrainTileBlock& b : layer.available[level])
      for (std::int64_t y = b.y0; y <= b.y1; ++y)
        for (std::int64_t x = b.x0; x <= b.x1; ++x) tiles.push_back({static_cast<int>(level), x, y});
  return tiles;
}

void check_ancestors(const TerrainLayer& layer, const std::vector<Tile>& tiles, Faults& faults) {
  for (const std::int64_t x : {0, 1}) faults.add("tiles of level 0 are not available", !is_available(layer, {0, x, 0}), name_of({0, x, 0}));
  for (const Tile& tile : tiles)
    if (tile.level > 0) faults.add("tiles have no parent", !is_available(layer, {tile.level - 1, tile.x >> 1, tile.y >> 1}), name_of(tile));
}

void add(TerrainTilesCheck& sum, double& squares, Faults& faults, const Tile& tile, const TileCheck& found, std::optional<double> bound) {
  const std::string place = name_of(tile);
  ++sum.tiles;
  sum.triangles += found.triangles, sum.vertices += found.vertices;
  sum.compared_cells += found.cells.compared;
  sum.max_error_m = std::max(sum.max_error_m, found.cells.max_error_m);
  squares += found.cells.squares;
  faults.add("triangles face the ground or have no area", found.clockwise, place);
  faults.add("edges or lists of sides are not manifold", found.not_manifold, place);
  faults.add("edges and areas of gaps are in tiles that must be whole", found.gaps, place);
  faults.add("sides differ from the eastern neighbour's", found.east_differs, place);
  faults.add("sides differ from the northern neighbour's", found.north_differs, place);
  faults.add("cells are valid and in no triangle", found.cells.uncovered, place);
  faults.add("cells are void and in a triangle", found.cells.covered_voids, place);
  faults.add("cells lie inside two triangles", found.cells.folds, place);
  if (bound) faults.add("cells are further off than " + number_text(*bound) + " m", found.too_far, place);
}

}  // namespace

TerrainTilesCheck check_terrain_tiles(const std::string& folder, const std::optional<TerrainTruth>& dem, std::optional<double> max_error_m, int threads,
                                      Progress& progress) {
  const std::string layer_path = folder + "/layer.json";
  const std::vector<std::byte> text = read_file(layer_path);
  const TerrainLayer layer = parse_layer({reinterpret_cast<const char*>(text.data()), text.size()}, layer_path);
  const std::unique_ptr<Truth> truth = dem ? std::make_unique<Truth>(*dem) : nullptr;
  const TileChecker checker(folder, layer, truth.get(), max_error_m);
  const std::vector<Tile> tiles = tiles_of(layer);
  TerrainTilesCheck sum;
  sum.levels = static_cast<int>(layer.available.size());
  Faults faults;
  check_ancestors(layer, tiles, faults);
  double squares = 0;
  const auto count = static_cast<std::int64_t>(tiles.size());
  progress.begin("checking tiles", count);
  for (std::int64_t first = 0; first < count; first += batch) {
    std::vector<TileCheck> found(static_cast<std::size_t>(std::min(batch, count - first)));
    parallel_for(static_cast<std::int64_t>(found.size()), threads, [&](std::int64_t i) { found[i] = checker.check(tiles[first + i]); });
    for (std::size_t i = 0; i < found.size(); ++i) add(sum, squares, faults, tiles[first + i], found[i], max_error_m);
    progress.advance(static_cast<std::int64_t>(found.size()));
  }
  progress.end();
  sum.rmse_m = sum.compared_cells > 0 ? std::sqrt(squares / static_cast<double>(sum.compared_cells)) : 0;
  if (truth) {
    sum.valid_cells = truth->count_valid();
    faults.add("valid cells lie on no tile of the deepest level, or in no triangle", sum.valid_cells - sum.compared_cells, "the DEM");
  }
  sum.faults = faults.lines();
  return sum;
}

}  // namespace arete
