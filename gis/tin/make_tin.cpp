#include "gis/tin/make_tin.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "gis/tin/drape_lines.h"
#include "gis/tin/greedy_insertion.h"
#include "gis/tin/mesh_tile.h"

namespace arete {
namespace {

constexpr std::int64_t tile_cells = 1024;
constexpr std::int64_t tile_memory = std::int64_t{240} << 20;  // of the worst: every cell a vertex
constexpr double least_tolerance = 8;  // of the arrangement of lines, in roundings of the file: no triangle turns over

/// The first cells of the tiles along one side, and the last cell: tile i has the cells [edges[i], edges[i + 1]], both included.
std::vector<std::int64_t> tile_edges(std::int64_t cells) {
  const std::int64_t count = std::max<std::int64_t>(1, (cells - 1 + tile_cells / 2) / tile_cells);
  std::vector<std::int64_t> edges;
  for (std::int64_t i = 0; i <= count; ++i) edges.push_back(i * (cells - 1) / count);
  return edges;
}

/// Gives the vertices of tiles, in the order of the tiles, their place in the whole mesh. Those on a border that an earlier tile has
/// had are that tile's.
class Welder {
 public:
  Welder(MeshStore& mesh, const std::vector<std::int64_t>& columns, const std::vector<std::int64_t>& rows)
      : mesh_(mesh), columns_(columns), rows_(rows) {}

  void add(const TileMesh& tile, std::size_t column, std::size_t row) {
    if (column == 0) above_ = std::move(below_), below_.clear(), before_.clear();
    const std::int32_t right = static_cast<std::int32_t>(columns_[column + 1] - columns_[column]) * tile.units;
    const std::int32_t bottom = static_cast<std::int32_t>(rows_[row + 1] - rows_[row]) * tile.units;
    const std::int64_t left_units = columns_[column] * tile.units;
    std::vector<MeshVertex> vertices;
    std::vector<std::int64_t> number(tile.x.size());
    Line after;
    std::int64_t next = mesh_.vertices();
    for (std::int32_t v = 0; v < tile.vertices(); ++v) {
      const std::int32_t x = tile.x[v], y = tile.y[v];
      const std::int64_t known = find(x, y, left_units, right, bottom, column, row, after);
      number[v] = known >= 0 ? known : next++;
      if (known < 0)
        vertices.push_back({static_cast<double>(columns_[column]) + static_cast<double>(x) / tile.units,
                            static_cast<double>(rows_[row]) + static_cast<double>(y) / tile.units, tile.z[v]});
      if (x == 0) first_[y] = number[v];
      if (y == 0) top_[left_units + x] = number[v];
      if (x == right) after[y] = number[v];
      if (y == bottom) below_[left_units + x] = number[v];
    }
    before_ = std::move(after);
    first_.clear(), top_.clear();
    std::vector<MeshTriangle> triangles;
    triangles.reserve(tile.origin.size() / 3);
    for (std::int32_t t = 0; t < tile.triangles(); ++t) {
      const auto [a, b, c] = tile.corners(t);
      triangles.push_back({number[a], number[c], number[b]});
    }
    mesh_.append_vertices(vertices);
    mesh_.append_triangles(triangles);
  }

 private:
  using Line = std::unordered_map<std::int64_t, std::int64_t>;  // numbers of vertices by their place on a border

  static std::int64_t find(const Line& line, std::int64_t at) {
    const auto found = line.find(at);
    return found == line.end() ? -1 : found->second;
  }
  /// The number of a vertex on a side of the tile that this tile or an earlier one has had; -1: none. Within a boundary an earlier tile may have no triangles
  /// there, or the tile several vertices in one place, which become one.
  std::int64_t find(std::int32_t x, std::int32_t y, std::int64_t left_units, std::int32_t right, std::int32_t bottom, std::size_t column, std::size_t row,
                    const Line& after) const {
    std::int64_t known = -1;
    if (y == 0 && row > 0) known = find(above_, left_units + x);
    if (known < 0 && x == 0 && column > 0) known = find(before_, y);
    if (known < 0 && x == 0) known = find(first_, y);
    if (known < 0 && y == 0) known = find(top_, left_units + x);
    if (known < 0 && x == right) known = find(after, y);
    if (known < 0 && y == bottom) known = find(below_, left_units + x);
    return known;
  }

  MeshStore& mesh_;
  const std::vector<std::int64_t>& columns_;
  const std::vector<std::int64_t>& rows_;
  Line above_, below_, before_;
  Line first_, top_;  // of the tile at hand
};

/// Cells on sides of tiles, each once.
class SideCells {
 public:
  /// Tiles in their order; (x, y) is the first cell of each.
  void add(const std::vector<SideCell>& cells, std::int64_t x, std::int64_t y, bool first_of_row, TileErrors& errors) {
    if (first_of_row) std::erase_if(seen_, [&](const auto& cell) { return cell.second < y; });
    for (const SideCell& cell : cells) {
      if (!seen_.emplace(x + cell.column, y + cell.row).second) continue;
      errors.max_error_m = std::max(errors.max_error_m, std::abs(cell.error_m));
      errors.squares += cell.error_m * cell.error_m;
      ++errors.cells;
    }
  }

 private:
  std::set<std::pair<std::int64_t, std::int64_t>> seen_;
};

DomainLines lines_of(const LineArrangement& arrangement, const TinLines& lines, const Window& window, std::size_t column, std::size_t row) {
  DomainLines domain{arrangement.of_tile(column, row), {}};
  if (!lines.boundary.empty())
    domain.inside = [&lines, window](const RasterPlace& place) {
      return is_inside(lines.boundary, {place[0] + static_cast<double>(window.x), place[1] + static_cast<double>(window.y)});
    };
  return domain;
}

void check(const Size& size, const TinOptions& options) {
  if (!(options.max_error_m > 0) || !std::isfinite(options.max_error_m))
    throw Error(ErrorKind::usage, "the maximum error must be above 0 m");
  if (size.width < 2 || size.height < 2)
    throw Error(ErrorKind::input, "a raster of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                                      " cells has no surface: a TIN needs 2 x 2 cells at least");
}

/// The least bound at which a mesh that has every cell as a vertex is not too steep for the rounding.
double least_bound(const RasterSource& raster, const Displacement& moved) {
  const Size size = raster.size();
  Raster<float> rows(size.width, 2);
  float steepest = 0;
  for (std::int64_t y = 0; y + 1 < size.height; ++y) {
    raster.read({0, y, size.width, 2}, rows.view());
    for (std::int64_t x = 0; x + 1 < size.width; ++x) {
      const float a = rows(x, 0), b = rows(x + 1, 0), c = rows(x, 1), d = rows(x + 1, 1);
      for (const float slopes : {std::abs(b - a) + std::abs(c - a), std::abs(b - a) + std::abs(d - b), std::abs(d - c) + std::abs(c - a), std::abs(d - c) + std::abs(d - b)})
        if (slopes > steepest) steepest = slopes;
    }
  }
  constexpr double diagonal2 = 2;  // of a cell, squared
  return (moved.rounding_cells + moved.bend_cells * diagonal2) * static_cast<double>(steepest) + moved.sag_m * diagonal2;
}

[[noreturn]] void fail_too_steep(const RasterSource& raster, const TinOptions& options) {
  char text[240];
  const char* moves = "the format or the CRS of the mesh moves coordinates by up to %.2g cells, too much for %g m ";
  const Displacement& moved = options.displacement;
  const double bent = moved.bend_cells > 0 ? moved.bend_cells * moved.longest_cells * moved.longest_cells : 0;
  const int length = std::snprintf(text, sizeof text, moves, moved.rounding_cells + bent, options.max_error_m);
  const std::size_t end = static_cast<std::size_t>(length);
  const double least = 1.01 * least_bound(raster, moved);
  if (options.lines.empty() && least > options.max_error_m)
    std::snprintf(text + end, sizeof text - end, "on terrain so steep: the bound must be at least %.3g m", least);
  else if (options.lines.empty())
    std::snprintf(text + end, sizeof text - end, "on terrain so steep beside voids or the border: raise the bound, or write PLY in the CRS of the DEM");
  else
    std::snprintf(text + end, sizeof text - end, "beside lines on terrain so steep: raise the bound, or write PLY in the CRS of the DEM");
  throw Error(ErrorKind::format, text);
}

/// Throws TooSteep.
Tin mesh_tiles(const RasterSource& raster, const TinOptions& options, const SideOptions& sides, Progress& progress) {
  const Size size = raster.size();
  const std::vector<std::int64_t> columns = tile_edges(size.width), rows = tile_edges(size.height);
  const std::int64_t across = static_cast<std::int64_t>(columns.size()) - 1, count = across * (static_cast<std::int64_t>(rows.size()) - 1);
  // A quarter of the memory is for the mesh, the rest for tiles at work and tiles that wait for their turn.
  const std::int64_t store_memory = options.scratch.memory_bytes / 4, tiles = std::max<std::int64_t>(1, (options.scratch.memory_bytes - store_memory) / tile_memory);
  const std::int64_t threads = std::min<std::int64_t>(tiles, resolve_threads(options.threads)), at_a_time = std::min(tiles, 4 * threads);

  std::optional<LineArrangement> arrangement;
  if (!options.lines.empty())
    arrangement.emplace(drape_lines(raster, options.lines, columns, rows, options.max_error_m / 2, options.displacement.longest_cells), columns, rows,
                        least_tolerance * options.displacement.rounding_cells);

  Tin tin;
  tin.mesh = MeshStore(options.scratch, store_memory);
  Welder welder(tin.mesh, columns, rows);
  TileErrors errors;
  SideCells side_cells;
  progress.begin("meshing", size.cells());
  std::vector<MeshedTile> batch(static_cast<std::size_t>(at_a_time));
  for (std::int64_t first = 0; first < count; first += at_a_time) {
    const std::int64_t now = std::min(at_a_time, count - first);
    const auto mesh_one = [&](std::int64_t i) {
      const std::size_t column = static_cast<std::size_t>((first + i) % across), row = static_cast<std::size_t>((first + i) / across);
      const Window window{columns[column], rows[row], columns[column + 1] - columns[column] + 1, rows[row + 1] - rows[row] + 1};
      Raster<float> cells(window.width, window.height);
      raster.read(window, cells.view());
      std::optional<DomainLines> lines;
      if (arrangement) lines = lines_of(*arrangement, options.lines, window, column, row);
      batch[static_cast<std::size_t>(i)] = mesh_tile(cells.view(), {options.max_error_m, options.height_step_m, options.displacement, options.passes, options.extra_share, sides},
                                                     column + 2 == columns.size(), row + 2 == rows.size(), lines ? &*lines : nullptr);
    };
    parallel_for(now, static_cast<int>(threads), mesh_one);
    std::int64_t done = 0;
    for (std::int64_t i = 0; i < now; ++i) {
      const std::size_t column = static_cast<std::size_t>((first + i) % across), row = static_cast<std::size_t>((first + i) / across);
      MeshedTile tile = std::move(batch[static_cast<std::size_t>(i)]);
      welder.add(tile.mesh, column, row);
      side_cells.add(tile.side_cells, columns[column], rows[row], column == 0, errors);
      errors.max_error_m = std::max(errors.max_error_m, tile.errors.max_error_m);
      errors.squares += tile.errors.squares;
      errors.cells += tile.errors.cells;
      errors.full_triangles += tile.errors.full_triangles;
      done += (columns[column + 1] - columns[column] + (column + 2 == columns.size())) * (rows[row + 1] - rows[row] + (row + 2 == rows.size()));
    }
    progress.advance(done);
  }
  progress.end();
  if (errors.cells == 0)
    throw Error(ErrorKind::input, options.lines.boundary.empty() ? "the raster has no valid cell: there is nothing to mesh"
                                                                 : "no valid cell of the raster lies inside the boundary: there is nothing to mesh");
  tin.report = {tin.mesh.vertices(), tin.mesh.triangles(), options.max_error_m, errors.max_error_m, std::sqrt(errors.squares / static_cast<double>(errors.cells)),
                errors.cells, errors.full_triangles};
  return tin;
}

}  // namespace

double height_step(double max_error_m) {
  return std::ldexp(1.0, std::clamp(static_cast<int>(std::floor(std::log2(max_error_m))) - 6, -16, -10));
}

Tin make_tin(const RasterSource& raster, const TinOptions& given, Progress& progress) {
  TinOptions options = given;
  if (options.height_step_m == 0 && options.max_error_m > 0) options.height_step_m = height_step(options.max_error_m);
  check(raster.size(), options);
  Displacement& moved = options.displacement;
  if (moved.sag_m > 0) moved.longest_cells = std::max(least_length, std::min(moved.longest_cells, std::sqrt(options.max_error_m / 8 / moved.sag_m)));
  // Both tiles at a side mesh it alike, from its own cells: none knows how steep it is beside it, which the displacement makes use of the bound. Where
  // what is kept for that is too little, all tiles keep more, and take shorter edges there.
  struct Reserve {
    double share;  // of the bound
    double longest_cells;
  };
  for (const Reserve& kept : {Reserve{1.0 / 16, any_length}, {0.25, 64}, {0.5, 8}, {0.5, 1}}) {
    try {
      return mesh_tiles(raster, options, {moved.any() ? (1 - kept.share) * options.max_error_m : 0, kept.longest_cells}, progress);
    } catch (const TooSteep&) {
      progress.end();
    }
  }
  fail_too_steep(raster, options);
}

}  // namespace arete
