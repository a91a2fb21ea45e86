#include "tools/tin_tiles.h"

#include <filesystem>

#include <fmt/format.h>

#include "gis/dem_file.h"
#include "gis/tin/terrain_tiles.h"
#include "tools/elevation_input.h"
#include "tools/mesh_report.h"
#include "tools/output_folder.h"

namespace arete::tools {
namespace {

namespace fs = std::filesystem;

/// With --overwrite a whole folder goes: only one that is a set of tiles may.
void check_replaced_folder(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored) && !fs::is_empty(path, ignored) && !fs::exists(fs::path(path) / "layer.json", ignored))
    throw Error(ErrorKind::disk, "'" + path + "' is a folder that holds something else than terrain tiles: choose another");
}

std::string describe(const TinTilesArguments& arguments, const TerrainTilesReport& report) {
  std::string text;
  for (std::size_t level = 0; level < report.levels.size(); ++level) {
    const TerrainLevelReport& l = report.levels[level];
    text += fmt::format("level {:>2}: {:>6} tiles, {:>10} triangles, {:>9}, bound {:.6g} m\n", level, grouped(l.tiles), grouped(l.triangles), readable_bytes(l.bytes), l.bound_m);
  }
  text += fmt::format("{}: tiles for Cesium, levels 0 to {}; heights {}\n", arguments.output, report.levels.size() - 1,
                      report.ellipsoidal ? "above the ellipsoid of WGS 84" : "as the DEM says them (Cesium takes them for ellipsoidal)");
  text += fmt::format("proven: at level {} no cell is further off than {:.6g} m; RMSE {:.4g} m over {} cells\n", report.levels.size() - 1, report.max_error_m,
                      report.rmse_m, grouped(report.cells));
  return text;
}

nlohmann::json to_json(const TinTilesArguments& arguments, const TerrainTilesReport& report) {
  nlohmann::json levels = nlohmann::json::array();
  for (const TerrainLevelReport& l : report.levels)
    levels.push_back({{"bound_m", l.bound_m}, {"max_error_m", l.max_error_m}, {"height_step_m", l.height_step_m}, {"tiles", l.tiles}, {"triangles", l.triangles},
                      {"vertices", l.vertices}, {"bytes", l.bytes}});
  return {{"output", arguments.output}, {"format", "quantized-mesh"}, {"levels", levels}, {"max_error_m", report.max_error_m}, {"rmse_m", report.rmse_m},
          {"cells", report.cells}, {"ellipsoidal", report.ellipsoidal}};
}

}  // namespace

bool is_tile_set_path(const std::string& path) { return path.ends_with('/') || path.ends_with(".tiles"); }

void run_tin_tiles(const TinTilesArguments& arguments, const CommonOptions& common) {
  check_replaced_folder(arguments.output);
  OutputFolder folder(arguments.output, common.overwrite);
  const ElevationInput input = open_elevations(arguments.input, arguments.dem, common.threads, arguments.level);
  limit_block_cache(common.memory_bytes / 8);
  TerrainTilesOptions options;
  options.max_error_m = arguments.max_error_m;
  options.fill = arguments.fill;
  options.passes = arguments.passes;
  options.threads = common.threads;
  options.name = fs::path(arguments.input).filename().string();
  const auto progress = make_progress(common);
  const TerrainTilesReport report = write_terrain_tiles(*input.source, input.geo, folder.staging(), options, *progress);
  folder.publish_whole();
  print_result(common, describe(arguments, report), to_json(arguments, report));
}

}  // namespace arete::tools
