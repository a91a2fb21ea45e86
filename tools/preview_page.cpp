#include "tools/preview_page.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gis/alignment.h"
#include "gis/colour_ramp.h"
#include "gis/geodesy.h"
#include "gis/staged_files.h"
#include "gis/terrain_page.h"
#include "tools/elevation_input.h"
#include "tools/mesh_input.h"

namespace arete::tools {
namespace {

// A tile of SRTM, 1201 or 3601 cells wide, divides into it well.
constexpr std::int64_t default_samples = 1280;
constexpr int ramp_stops = 17;
using Affine = std::array<double, 6>;

/// A DEM, and where its cells lie: metres east and south of the corner of the first.
struct Ground {
  std::string path;
  ElevationInput dem;
  CellSize cell;
  Affine placement;
};

/// Of `inner`, then `outer`.
Affine after(const Affine& outer, const Affine& inner) {
  Affine result;
  for (std::size_t r : {0u, 3u}) {
    for (std::size_t c = 0; c < 3; ++c) result[r + c] = outer[r + 1] * inner[c] + outer[r + 2] * inner[3 + c];
    result[r] += outer[r];
  }
  return result;
}

Ground open_ground(const std::string& path, const PageArguments& arguments, const CommonOptions& common) {
  if (is_mesh_file(path))
    throw Error(ErrorKind::format, fmt::format("cannot show '{}' on a page: it is a mesh, and pages are made of DEMs; draw it as a picture (.png), or give the DEM",
                                               path));
  Ground ground{path, open_elevations(path, arguments.reading, common.threads), {}, {}};
  ground.cell = cell_size(ground.dem.geo, ground.dem.source->size());
  ground.placement = {0, ground.cell.x_m, 0, 0, 0, ground.cell.y_m};
  return ground;
}

std::string plain_metres(double value, double span) { return fmt::format("{:.{}f}", value, span >= 20 ? 0 : span >= 2 ? 1 : 2); }

std::vector<std::string> facts_of(const Ground& ground, const Overview& overview, const Raster<float>& cells, double step_m) {
  const Size size = ground.dem.source->size();
  const bool metric = ground.dem.geo.transform.has_value();
  const bool square = std::abs(ground.cell.x_m - ground.cell.y_m) < 0.005 * ground.cell.y_m;
  std::string first = fmt::format("{} \u00d7 {} cells", size.width, size.height);
  if (metric) first += square ? fmt::format(" of {:.3g} m", ground.cell.x_m) : fmt::format(" of {:.3g} \u00d7 {:.3g} m", ground.cell.x_m, ground.cell.y_m);
  std::vector<std::string> facts = {first};
  if (overview.valid > 0) {
    const double span = overview.high_m - overview.low_m;
    facts.push_back(fmt::format("{} to {} m", plain_metres(overview.low_m, span), plain_metres(overview.high_m, span)));
  } else {
    facts.push_back("no valid cell");
  }
  const std::string shown = cells.size() == size ? "all cells shown" : fmt::format("averaged to {} \u00d7 {}", cells.width(), cells.height());
  facts.push_back(step_m > 0 ? fmt::format("{}, heights in steps of {:.2g} m", shown, step_m) : shown);
  return facts;
}

PageTerrain make_terrain(const Ground& ground, ReliefDrape drape, std::int64_t samples, int threads, Progress& progress) {
  const Size size = ground.dem.source->size();
  const std::int64_t block = (std::max(size.width, size.height) + samples - 1) / samples;
  PageTerrain terrain;
  terrain.name = std::filesystem::path(ground.path).filename().string();
  terrain.cells = block == drape.ground.across ? drape.ground.cells.clone() : make_overview(*ground.dem.source, block, block, threads, progress).cells;
  const auto cells = static_cast<double>(block);
  terrain.placement = after(ground.placement, {0, cells, 0, 0, 0, cells});
  terrain.picture = std::move(drape.picture);
  terrain.pixels_per_cell = cells / static_cast<double>(drape.ground.across);
  terrain.facts = facts_of(ground, drape.ground, terrain.cells, quantise_heights(terrain.cells.view()).step_m);
  return terrain;
}

}  // namespace

bool is_page(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".html" || extension == ".htm";
}

void write_preview_page(const PageArguments& arguments, const CommonOptions& common) {
  StagedFiles(arguments.output, common.overwrite);  // refuses before the work
  std::vector<Ground> grounds;
  grounds.push_back(open_ground(arguments.input, arguments, common));
  if (!arguments.compare.empty()) {
    grounds.push_back(open_ground(arguments.compare, arguments, common));
    const auto placed = [](const Ground& ground) { return Placed{ground.path, ground.dem.geo, ground.dem.source->size()}; };
    grounds[1].placement = after(grounds[0].placement, place_in_cells(placed(grounds[0]), placed(grounds[1])));
  }
  const auto progress = make_progress(common);
  const std::int64_t samples = arguments.relief.width > 0 ? arguments.relief.width : default_samples;
  std::vector<ReliefPanel> panels;
  for (const Ground& ground : grounds) panels.push_back({ground.path, ground.dem.source.get(), ground.cell});
  Drapes drapes = drape_reliefs(panels, 2 * samples, arguments.relief, *progress);

  TerrainPage page;
  page.exaggeration = std::clamp(drapes.exaggeration, 0.5, 20.0);
  page.metric = grounds[0].dem.geo.transform.has_value();
  if (arguments.legend && drapes.colour_low_m < drapes.colour_high_m) {
    const ColourRamp ramp = named_ramp(arguments.relief.ramp);
    for (int i = 0; i < ramp_stops; ++i) page.ramp.push_back(ramp.at(static_cast<double>(i) / (ramp_stops - 1)));
    page.low_m = drapes.colour_low_m, page.high_m = drapes.colour_high_m;
  }
  nlohmann::json terrains = nlohmann::json::array();
  std::string text = arguments.output + ":";
  for (std::size_t i = 0; i < grounds.size(); ++i) {
    if (drapes.drapes[i].ground.valid == 0) warn(common, "'" + grounds[i].path + "' has no valid cell");
    page.terrains.push_back(make_terrain(grounds[i], std::move(drapes.drapes[i]), samples, common.threads, *progress));
    const PageTerrain& terrain = page.terrains.back();
    page.title += (i > 0 ? " | " : "") + terrain.name;
    text += fmt::format("{} {} as {} x {} samples", i > 0 ? "," : "", terrain.name, terrain.cells.width(), terrain.cells.height());
    terrains.push_back({{"path", grounds[i].path}, {"width", terrain.cells.width()}, {"height", terrain.cells.height()},
                        {"step_m", quantise_heights(terrain.cells.view()).step_m}});
  }
  write_terrain_page(arguments.output, page, common.overwrite);
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(arguments.output));
  print_result(common, fmt::format("{}, exaggerated {:g} times, {}\n", text, page.exaggeration, readable_bytes(bytes)),
               {{"page", arguments.output}, {"terrains", terrains}, {"exaggeration", page.exaggeration}, {"bytes", bytes}});
}

}  // namespace arete::tools
