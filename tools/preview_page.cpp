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

std::vector<std::string> facts_of(const Ground& ground, const Overview& overview, const PageHeights& heights) {
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
  const std::string shown = heights.size == size ? "all cells shown" : fmt::format("averaged to {} \u00d7 {}", heights.size.width, heights.size.height);
  facts.push_back(heights.step_m > 0 ? fmt::format("{}, heights within {:.2g} m", shown, heights.error_m()) : shown);
  return facts;
}

PageTerrain make_terrain(const Ground& ground, ReliefDrape drape, std::int64_t samples, int threads, Progress& progress) {
  const Size size = ground.dem.source->size();
  const std::int64_t block = (std::max(size.width, size.height) + samples - 1) / samples;
  PageTerrain terrain;
  terrain.name = std::filesystem::path(ground.path).filename().string();
  const bool drawn = block == drape.ground.across;
  const Raster<float> averaged = drawn ? Raster<float>() : make_overview(*ground.dem.source, block, block, threads, progress).cells;
  terrain.heights = quantise_heights(drawn ? std::as_const(drape.ground.cells).view() : averaged.view());
  const auto cells = static_cast<double>(block);
  terrain.placement = after(ground.placement, {0, cells, 0, 0, 0, cells});
  terrain.picture = std::move(drape.picture);
  terrain.pixels_per_cell = cells / static_cast<double>(drape.ground.across);
  terrain.facts = facts_of(ground, drape.ground, terrain.heights);
  return terrain;
}

}  // namespace

bool is_page(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".html" || extension == ".htm";
}

TerrainPage make_preview_page(const PageArguments& arguments, const CommonOptions& common, Progress& progress) {
  std::vector<Ground> grounds;
  grounds.push_back(open_ground(arguments.input, arguments, common));
  if (!arguments.compare.empty()) {
    grounds.push_back(open_ground(arguments.compare, arguments, common));
    const auto placed = [](const Ground& ground) { return Placed{ground.path, ground.dem.geo, ground.dem.source->size()}; };
    grounds[1].placement = after(grounds[0].placement, place_in_cells(placed(grounds[0]), placed(grounds[1])));
  }
  const std::int64_t samples = arguments.relief.width > 0 ? arguments.relief.width : default_samples;
  std::vector<ReliefPanel> panels;
  for (const Ground& ground : grounds) panels.push_back({ground.path, ground.dem.source.get(), ground.cell});
  Drapes drapes = drape_reliefs(panels, 2 * samples, arguments.relief, progress);

  TerrainPage page;
  page.exaggeration = std::clamp(drapes.exaggeration, 0.5, 20.0);
  page.metric = grounds[0].dem.geo.transform.has_value();
  page.credit = arguments.credit;
  if (arguments.legend && drapes.colour_low_m < drapes.colour_high_m) {
    const ColourRamp ramp = named_ramp(arguments.relief.ramp);
    for (int i = 0; i < ramp_stops; ++i) page.ramp.push_back(ramp.at(static_cast<double>(i) / (ramp_stops - 1)));
    page.low_m = drapes.colour_low_m, page.high_m = drapes.colour_high_m;
  }
  for (std::size_t i = 0; i < grounds.size(); ++i) {
    if (drapes.drapes[i].ground.valid == 0) warn(common, "'" + grounds[i].path + "' has no valid cell");
    page.terrains.push_back(make_terrain(grounds[i], std::move(drapes.drapes[i]), samples, common.threads, progress));
    page.title += (i > 0 ? " | " : "") + page.terrains.back().name;
  }
  return page;
}

void write_preview_page(const PageArguments& arguments, const CommonOptions& common) {
  StagedFiles(arguments.output, common.overwrite);  // refuses before the work
  const auto progress = make_progress(common);
  const TerrainPage page = make_preview_page(arguments, common, *progress);
  write_terrain_page(arguments.output, page, common.overwrite);

  nlohmann::json terrains = nlohmann::json::array();
  std::string text = arguments.output + ":";
  for (const PageTerrain& terrain : page.terrains) {
    const PageHeights& heights = terrain.heights;
    text += fmt::format("{} {} as {} x {} samples within {:.2g} m", terrains.empty() ? "" : ",", terrain.name, heights.size.width, heights.size.height, heights.error_m());
    terrains.push_back({{"path", terrains.empty() ? arguments.input : arguments.compare}, {"width", heights.size.width}, {"height", heights.size.height},
                        {"step_m", heights.step_m}, {"max_error_m", heights.error_m()}});
  }
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(arguments.output));
  print_result(common, fmt::format("{}, exaggerated {:g} times, {}\n", text, page.exaggeration, readable_bytes(bytes)),
               {{"page", arguments.output}, {"terrains", terrains}, {"exaggeration", page.exaggeration}, {"bytes", bytes}});
}

}  // namespace arete::tools
