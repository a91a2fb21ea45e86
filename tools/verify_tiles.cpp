#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gis/mesh/check_terrain_tiles.h"
#include "tools/elevation_input.h"
#include "tools/mesh_report.h"
#include "tools/verify.h"

namespace arete::tools {

bool is_tile_set(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

FileReport verify_tiles(const VerifyOptions& options, const CommonOptions& common) {
  const auto progress = make_progress(common);
  std::optional<ElevationInput> dem;
  if (!options.original.empty()) dem = open_elevations(options.original, options.dem, common.threads);
  limit_block_cache(common.memory_bytes / 8);
  std::optional<TerrainTruth> truth;
  if (dem) truth.emplace(TerrainTruth{*dem->source, dem->geo});
  const TerrainTilesCheck check = check_terrain_tiles(options.file, truth, options.max_error_m, common.threads, *progress);
  if (!check.faults.empty()) throw Error(ErrorKind::damaged, fmt::format("'{}' is no sound set of terrain tiles: {}", options.file, fmt::join(check.faults, "; ")));
  FileReport said;
  said.text = fmt::format("{}: {} tiles of {} levels, {} triangles, {} vertices; neighbours of a level agree on their sides\n", options.file, grouped(check.tiles), check.levels,
                          grouped(check.triangles), grouped(check.vertices));
  said.data = {{"file", options.file}, {"format", "quantized-mesh"}, {"tiles", check.tiles}, {"levels", check.levels}, {"triangles", check.triangles}, {"vertices", check.vertices}};
  if (!dem) return said;
  said.text += fmt::format("level {}: largest error {:.6g} m, RMSE {:.4g} m over {} cells\n", check.levels - 1, check.max_error_m, check.rmse_m, grouped(check.compared_cells));
  said.data.update({{"max_error_m", check.max_error_m}, {"rmse_m", check.rmse_m}, {"cells", check.compared_cells}});
  if (options.max_error_m) {
    said.text += fmt::format("bound of {} m: kept\n", *options.max_error_m);
    said.data["kept"] = true;
  }
  return said;
}

}  // namespace arete::tools
