#include "gis/tin/make_tin.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "gis/tin/mesh_tile.h"

namespace arete {
namespace {

constexpr std::int64_t tile_cells = 1024;
constexpr std::int64_t tile_memory = std::int64_t{150} << 20;

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
      const std::int64_t known = y == 0 && row > 0 ? above_.at(left_units + x) : x == 0 && column > 0 ? before_.at(y) : -1;
      number[v] = known >= 0 ? known : next++;
      if (known < 0)
        vertices.push_back({static_cast<double>(columns_[column]) + static_cast<double>(x) / tile.units,
                            static_cast<double>(rows_[row]) + static_cast<double>(y) / tile.units, tile.z[v]});
      if (x == right) after[y] = number[v];
      if (y == bottom) below_[left_units + x] = number[v];
    }
    before_ = std::move(after);
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
  MeshStore& mesh_;
  const std::vector<std::int64_t>& columns_;
  const std::vector<std::int64_t>& rows_;
  Line above_, below_, before_;
};

void check(const Size& size, const TinOptions& options) {
  if (!(options.max_error_m > 0) || !std::isfinite(options.max_error_m))
    throw Error(ErrorKind::usage, "the maximum error must be above 0 m");
  if (size.width < 2 || size.height < 2)
    throw Error(ErrorKind::input, "a raster of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                                      " cells has no surface: a TIN needs 2 x 2 cells at least");
}

}  // namespace

double height_step(double max_error_m) {
  return std::ldexp(1.0, std::clamp(static_cast<int>(std::floor(std::log2(max_error_m))) - 6, -16, -10));
}

Tin make_tin(const RasterSource& raster, const TinOptions& options, Progress& progress) {
  const Size size = raster.size();
  check(size, options);
  const std::vector<std::int64_t> columns = tile_edges(size.width), rows = tile_edges(size.height);
  const std::int64_t across = static_cast<std::int64_t>(columns.size()) - 1, count = across * (static_cast<std::int64_t>(rows.size()) - 1);
  const int threads = static_cast<int>(std::clamp<std::int64_t>(options.scratch.memory_bytes / 2 / tile_memory, 1, resolve_threads(options.threads)));

  Tin tin;
  tin.mesh = MeshStore(options.scratch, options.scratch.memory_bytes / 2);
  Welder welder(tin.mesh, columns, rows);
  TileErrors errors;
  progress.begin("meshing", size.cells());
  std::vector<MeshedTile> batch(static_cast<std::size_t>(threads));
  for (std::int64_t first = 0; first < count; first += threads) {
    const std::int64_t now = std::min<std::int64_t>(threads, count - first);
    parallel_for(now, threads, [&](std::int64_t i) {
      const std::size_t column = static_cast<std::size_t>((first + i) % across), row = static_cast<std::size_t>((first + i) / across);
      const Window window{columns[column], rows[row], columns[column + 1] - columns[column] + 1, rows[row + 1] - rows[row] + 1};
      Raster<float> cells(window.width, window.height);
      raster.read(window, cells.view());
      batch[static_cast<std::size_t>(i)] = mesh_tile(cells.view(), {options.max_error_m, options.height_step_m, options.rounding_cells, options.passes},
                                                     column + 2 == columns.size(), row + 2 == rows.size());
    });
    std::int64_t done = 0;
    for (std::int64_t i = 0; i < now; ++i) {
      const std::size_t column = static_cast<std::size_t>((first + i) % across), row = static_cast<std::size_t>((first + i) / across);
      MeshedTile tile = std::move(batch[static_cast<std::size_t>(i)]);
      welder.add(tile.mesh, column, row);
      errors.max_error_m = std::max(errors.max_error_m, tile.errors.max_error_m);
      errors.squares += tile.errors.squares;
      errors.cells += tile.errors.cells;
      errors.full_triangles += tile.errors.full_triangles;
      done += (columns[column + 1] - columns[column] + (column + 2 == columns.size())) * (rows[row + 1] - rows[row] + (row + 2 == rows.size()));
    }
    progress.advance(done);
  }
  progress.end();
  if (errors.cells == 0) throw Error(ErrorKind::input, "the raster has no valid cell: there is nothing to mesh");
  tin.report = {tin.mesh.vertices(), tin.mesh.triangles(), errors.max_error_m, std::sqrt(errors.squares / static_cast<double>(errors.cells)),
                errors.cells, errors.full_triangles};
  return tin;
}

}  // namespace arete
