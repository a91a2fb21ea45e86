#include "gis/tin/terrain_tile_mesh.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/support/error.h"
#include "gis/tin/mesh_tile.h"

namespace arete {
namespace {

constexpr int most_tries = 20;
constexpr int mesh_units = 2;  // of TileMesh, to a cell

/// Parts along each side of a tile: a side of a triangle is at most 180 / 2^level / parts degrees long, and sags by R d²/8 below the globe.
/// That is kept below half of what Cesium takes for the error of the level, 77 km / 2^level.
int parts_of(int level) { return level < 3 ? 31 : level < 8 ? 7 : 1; }

/// The mesh of a whole grid: units to a cell as mesh_units, from the north-western corner; triangles counter-clockwise seen from above.
struct GridMesh {
  std::vector<std::int32_t> x, y;
  std::vector<double> z;
  std::vector<std::uint32_t> triangles;
  double max_error_m = 0;
};

class PartJoiner {
 public:
  PartJoiner(GridMesh& mesh, int cells) : mesh_(mesh), side_(cells * mesh_units) {}

  void add(const TileMesh& part, std::int32_t left, std::int32_t top) {
    std::vector<std::uint32_t> number(part.x.size());
    for (std::int32_t v = 0; v < part.vertices(); ++v) {
      const std::int32_t x = left * mesh_units + part.x[v], y = top * mesh_units + part.y[v];
      const auto next = static_cast<std::uint32_t>(mesh_.x.size());
      number[v] = x % side_ == 0 || y % side_ == 0 ? shared_.try_emplace((static_cast<std::int64_t>(y) << 32) + x, next).first->second : next;
      if (number[v] == next) mesh_.x.push_back(x), mesh_.y.push_back(y), mesh_.z.push_back(part.z[v]);
    }
    for (std::int32_t t = 0; t < part.triangles(); ++t) {
      const auto [a, b, c] = part.corners(t);
      mesh_.triangles.insert(mesh_.triangles.end(), {number[a], number[c], number[b]});
    }
  }

 private:
  GridMesh& mesh_;
  std::int32_t side_;
  std::unordered_map<std::int64_t, std::uint32_t> shared_;  // vertices on the lines between parts, by place
};

/// Squares of the grid, in order.
using Squares = std::set<std::pair<std::int32_t, std::int32_t>>;  // row, column

std::vector<CellSquare> squares_in(const Squares& squares, std::int32_t left, std::int32_t top, std::int32_t cells) {
  std::vector<CellSquare> inside;
  for (const auto& [row, column] : squares)
    if (column >= left && row >= top && column < left + cells && row < top + cells) inside.push_back({column - left, row - top});
  return inside;
}

GridMesh mesh_grid(const Raster<float>& heights, int parts, TileOptions options, const Squares& squares) {
  const int cells = terrain_grid_cells / parts;
  GridMesh mesh;
  PartJoiner joiner(mesh, cells);
  Raster<float> part(cells + 1, cells + 1);
  for (int row = 0; row < parts; ++row)
    for (int column = 0; column < parts; ++column) {
      ViewSource(heights.view()).read({column * cells, row * cells, cells + 1, cells + 1}, part.view());
      const std::vector<CellSquare> kept = squares_in(squares, column * cells, row * cells, cells);
      options.squares = kept;
      const MeshedTile meshed = mesh_tile(part.view(), options, true, true);
      mesh.max_error_m = std::max(mesh.max_error_m, meshed.errors.max_error_m);
      joiner.add(meshed.mesh, column * cells, row * cells);
    }
  return mesh;
}

/// Half units, at the corners of voids, go towards the north-east in every tile.
std::uint16_t quantized(std::int32_t units) { return static_cast<std::uint16_t>((units * quantized_per_cell + 1) / mesh_units); }

bool is_float(double value) { return static_cast<double>(static_cast<float>(value)) == value; }

/// The finest step, a power of two, that holds the heights of the tile between a minimum and a maximum that floats hold.
double step_for(double low, double high, double level_step) {
  double step = std::min(level_step, std::max(least_height_step(high - low), 1.0 / 65536));
  while (step < level_step && !(is_float(low) && is_float(low + quantized_end * step))) step *= 2;
  return step;
}

QuantizedMesh quantize(const GridMesh& mesh, const TerrainTileId& tile, double level_step) {
  QuantizedMesh out;
  if (mesh.triangles.empty()) return out;
  const auto [low, high] = std::minmax_element(mesh.z.begin(), mesh.z.end());
  const double step = step_for(*low, *high, level_step);
  if (*high - *low > quantized_end * step)
    throw Error(ErrorKind::format, "a tile of " + std::to_string(*high - *low) + " m of relief does not fit in steps of " + std::to_string(step) + " m");
  out.minimum_m = static_cast<float>(*low);
  out.maximum_m = static_cast<float>(*low + quantized_end * step);
  for (std::size_t i = 0; i < mesh.x.size(); ++i) {
    out.u.push_back(quantized(mesh.x[i]));
    out.v.push_back(quantized(mesh_units * terrain_grid_cells - mesh.y[i]));
    out.height.push_back(static_cast<std::uint16_t>(std::lround((mesh.z[i] - *low) / step)));
  }
  out.triangles = mesh.triangles;
  sort_by_use(out);
  place_quantized_mesh(out, terrain_tile_rectangle(tile.level, tile.x, tile.y));
  return out;
}

std::pair<std::int32_t, std::int32_t> square_of(const TerrainPoint& p) {
  const auto at = [](double place) { return std::min(static_cast<std::int32_t>(place / quantized_per_cell), terrain_grid_cells - 1); };
  return {terrain_grid_cells - 1 - at(p.v), at(p.u)};
}

/// Compares with the centres. Those on the western and southern sides are the tile's own. The squares about those beyond the bound are
/// added to `squares`.
void measure(TerrainTileMesh& tile, const TerrainGrid& grid, const TerrainBound& bound, Squares& squares) {
  const TerrainTileErrors errors = compare_terrain_tile(tile.mesh, grid.centres);
  tile.centre_error_m = errors.max_error_m;
  tile.squares = 0, tile.centres = 0;
  for (std::size_t i = 0; i < grid.centres.size(); ++i) {
    const TerrainPoint& p = grid.centres[i];
    if (errors.error_m[i] > bound.max_error_m) squares.insert(square_of(p));
    if (std::isnan(errors.error_m[i]) || p.u >= quantized_end || p.v >= quantized_end) continue;
    tile.squares += errors.error_m[i] * errors.error_m[i];
    ++tile.centres;
  }
  tile.kept = errors.max_error_m <= bound.max_error_m && errors.uncovered == 0 && errors.folds == 0 && errors.clockwise == 0 &&
              (bound.filled || errors.covered_voids == 0);
}

}  // namespace

double least_height_step(double range_m) { return range_m > 0 ? std::exp2(std::ceil(std::log2(range_m / quantized_end))) : 0; }

TerrainTileMesh mesh_terrain_tile(const TerrainTileId& tile, const TerrainGrid& grid, const TerrainBound& bound) {
  TerrainTileMesh best;
  Squares squares;
  // Elevations of cells are rounded to the step when they become vertices.
  const double least = 0.51 * bound.height_step_m + 2 * cell_step_m;
  for (int tried = 0; tried < most_tries; ++tried) {
    // Each try has other cells at the edge of the bound: less and less is asked of them.
    const double within = std::max(least, bound.max_error_m * std::max(1 - 0.12 * tried, 0.3));
    TileOptions options;
    options.max_error_m = within;
    options.height_step_m = bound.height_step_m;
    options.passes = bound.passes;
    options.sides.error_m = bound.side_error_m;
    const GridMesh mesh = mesh_grid(grid.heights, parts_of(tile.level), options, squares);
    TerrainTileMesh made;
    made.mesh = quantize(mesh, tile, bound.height_step_m);
    made.grid_error_m = mesh.max_error_m;
    const std::size_t before = squares.size();
    measure(made, grid, bound, squares);
    if (tried == 0 || made.kept || made.centre_error_m < best.centre_error_m) best = std::move(made);
    if (best.kept) return best;
    if (squares.size() == before && within == least) return best;
  }
  return best;
}

}  // namespace arete
