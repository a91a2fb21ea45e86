#include "gis/tin/terrain_tiles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include "core/support/error.h"
#include "core/support/file.h"
#include "core/support/parallel.h"
#include "gis/globe_placement.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/terrain_layer.h"
#include "gis/tin/make_tin.h"
#include "gis/tin/terrain_pyramid.h"
#include "gis/tin/terrain_tile_mesh.h"

namespace arete {
namespace {

constexpr double finest_step_m = 1.0 / 65536;

/// What is known of a level before it is meshed.
struct Level {
  double range_m = 0;  ///< the largest of a tile's grid
  TerrainBound bound;
};

bool is_deepest(const TerrainTileId& tile, const std::vector<Level>& levels) { return tile.level + 1 == static_cast<int>(levels.size()); }

/// Voids become ground at height 0.
void fill_with_sea(Raster<float>& heights) {
  for (std::int64_t i = 0; i < heights.size().cells(); ++i)
    if (is_void(heights.data()[i])) heights.data()[i] = 0;
}

double range_of(const Raster<float>& heights) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::int64_t i = 0; i < heights.size().cells(); ++i) {
    const double h = heights.data()[i];
    if (!std::isnan(h)) low = std::min(low, h), high = std::max(high, h);
  }
  return high - low;
}

/// The largest power of two not above.
double power_below(double value) { return std::exp2(std::floor(std::log2(value))); }

class TileSetMaker {
 public:
  TileSetMaker(TerrainPyramid& pyramid, const std::string& folder, const TerrainTilesOptions& options, int deepest, Progress& progress)
      : pyramid_(pyramid), folder_(folder), options_(options), progress_(progress), levels_(static_cast<std::size_t>(deepest) + 1), report_{} {
    for (int level = 0; level <= deepest; ++level) {
      TerrainBound& bound = levels_[level].bound;
      bound.max_error_m = std::ldexp(options.max_error_m, deepest - level);
      bound.filled = level < deepest || options.fill;
      bound.passes = options.passes;
    }
  }

  /// How much relief tiles have.
  void survey() {
    progress_.begin("looking at tiles", pyramid_.leaves());
    std::vector<double> ranges(TerrainPyramid::batch);
    bool any = false;
    pyramid_.walk([&](std::size_t slot, const TerrainTileId& tile, TerrainGrid& grid) { fill(tile, grid), ranges[slot] = range_of(grid.heights); },
                  [&](std::size_t slot, const TerrainTileId& tile) { any = true, levels_[tile.level].range_m = std::max(levels_[tile.level].range_m, ranges[slot]); },
                  progress_);
    progress_.end();
    if (!any) throw Error(ErrorKind::input, "the raster has no valid cell: there is nothing to mesh");
  }

  /// Chooses the steps of heights. Throws where 15 bits are too few for the deepest level.
  void choose_steps() {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      TerrainBound& bound = levels_[i].bound;
      // Simplification frees heights within the bound.
      const auto least = [&](double error) { return std::max(finest_step_m, least_height_step(levels_[i].range_m + 3 * error)); };
      if (i + 1 == levels_.size()) {
        double smallest = bound.max_error_m;
        while (smallest < 2 * least(smallest)) smallest = 2 * least(smallest);
        if (bound.max_error_m < smallest) refuse(smallest);
      } else {
        bound.max_error_m = std::max(bound.max_error_m, 2 * least(bound.max_error_m));
      }
      bound.height_step_m = std::max(least(bound.max_error_m), std::min(0.25, power_below(bound.max_error_m / 64)));
      bound.side_error_m = bound.max_error_m;
    }
    levels_.back().bound.side_error_m = levels_.back().bound.max_error_m / 2;
  }

  /// Makes all tiles; false where the sides of tiles left some without a mesh within the bound.
  bool make() {
    report_.levels.assign(levels_.size(), {});
    report_.cells = 0, squares_ = 0, worst_ = 0, kept_ = true;
    made_.assign(levels_.size(), {});
    std::vector<TerrainTileMesh> meshes(TerrainPyramid::batch);
    progress_.begin("meshing", pyramid_.leaves());
    pyramid_.walk(
        [&](std::size_t slot, const TerrainTileId& tile, TerrainGrid& grid) {
          fill(tile, grid);
          meshes[slot] = mesh_terrain_tile(tile, grid, levels_[tile.level].bound);
        },
        [&](std::size_t slot, const TerrainTileId& tile) { collect(std::exchange(meshes[slot], {}), tile); }, progress_);
    progress_.end();
    return kept_;
  }

  bool tighten_sides() {
    TerrainBound& bound = levels_.back().bound;
    bound.side_error_m /= 4;
    return bound.side_error_m > bound.height_step_m;
  }

  [[noreturn]] void refuse(double smallest) const {
    throw Error(ErrorKind::usage, "--max-error " + number_text(options_.max_error_m) + " m is finer than these tiles, with 15 bits for heights, can keep: their smallest is " +
                                      number_text(std::ceil(smallest * 1e4) / 1e4) + " m");
  }
  double worst() const { return worst_; }

  /// Cesium asks for both tiles of level 0.
  void add_roots() {
    for (const std::int64_t x : {0, 1}) {
      if (made_[0].contains({x, 0})) continue;
      TerrainGrid sea;
      sea.heights = Raster<float>(terrain_grid_cells + 1, terrain_grid_cells + 1, 0.0f);
      TerrainBound bound = levels_[0].bound;
      bound.filled = true;
      collect(mesh_terrain_tile({0, x, 0}, sea, bound), {0, x, 0});
    }
  }

  TerrainTilesReport finish(const TileRectangle& extent) {
    TerrainLayer layer{options_.name, extent, {}, options_.fill};
    for (const auto& tiles : made_) layer.available.push_back(blocks_of(tiles));
    OutputFile file(folder_ + "/layer.json");
    file.text(describe_layer(layer));
    file.close();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      report_.levels[i].bound_m = levels_[i].bound.max_error_m;
      report_.levels[i].height_step_m = levels_[i].bound.height_step_m;
    }
    report_.max_error_m = worst_;
    report_.rmse_m = report_.cells > 0 ? std::sqrt(squares_ / static_cast<double>(report_.cells)) : 0;
    return report_;
  }

 private:
  void fill(const TerrainTileId& tile, TerrainGrid& grid) const {
    if (levels_[tile.level].bound.filled) fill_with_sea(grid.heights);
  }

  void collect(TerrainTileMesh made, const TerrainTileId& tile) {
    TerrainLevelReport& level = report_.levels[tile.level];
    if (is_deepest(tile, levels_)) {
      // A tile that has the sides of its neighbours alone shows nothing.
      if (made.centres == 0 && made.centre_error_m == 0 && !levels_.back().bound.filled) return;
      kept_ = kept_ && made.kept;
      worst_ = std::max(worst_, made.centre_error_m);
      squares_ += made.squares;
      report_.cells += made.centres;
    }
    level.max_error_m = std::max(level.max_error_m, is_deepest(tile, levels_) ? made.centre_error_m : made.grid_error_m);
    const std::int64_t columns = std::int64_t{2} << tile.level, x = ((tile.x % columns) + columns) % columns;
    const std::vector<std::byte> bytes = encode_quantized_mesh(made.mesh);
    const std::string path = terrain_tile_path(folder_, tile.level, x, tile.y);
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
    OutputFile file(path);
    file.write(bytes);
    file.close();
    made_[tile.level].insert({x, tile.y});
    ++level.tiles;
    level.triangles += static_cast<std::int64_t>(made.mesh.triangles.size() / 3);
    level.vertices += made.mesh.vertices();
    level.bytes += static_cast<std::int64_t>(bytes.size());
  }

  TerrainPyramid& pyramid_;
  const std::string& folder_;
  const TerrainTilesOptions& options_;
  Progress& progress_;
  std::vector<Level> levels_;
  TerrainTilesReport report_;
  std::vector<std::set<std::pair<std::int64_t, std::int64_t>>> made_;
  double squares_ = 0, worst_ = 0;
  bool kept_ = true;
};

}  // namespace

TerrainTilesReport write_terrain_tiles(const RasterSource& raster, const GeoReference& geo, const std::string& folder, const TerrainTilesOptions& options,
                                       Progress& progress) {
  if (!(options.max_error_m > 0) || !std::isfinite(options.max_error_m)) throw Error(ErrorKind::usage, "the maximum error must be above 0 m");
  if (raster.size().width < 2 || raster.size().height < 2) throw Error(ErrorKind::input, "a raster of fewer than 2 x 2 cells has no surface");
  const GlobePlacement placement(geo, raster.size());
  TileRectangle extent;
  const TerrainTileRange deepest = deepest_terrain_level(placement, raster.size(), extent);
  const TerrainSampler sampler(raster, placement);
  TerrainPyramid pyramid(sampler, deepest, resolve_threads(options.threads));
  TileSetMaker maker(pyramid, folder, options, deepest.level, progress);
  maker.survey();
  maker.choose_steps();
  while (!maker.make())
    if (!maker.tighten_sides()) maker.refuse(maker.worst());
  maker.add_roots();
  TerrainTilesReport report = maker.finish(extent);
  report.ellipsoidal = placement.ellipsoidal();
  return report;
}

}  // namespace arete
