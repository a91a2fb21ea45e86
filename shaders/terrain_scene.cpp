#include "shaders/terrain_scene.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/support/error.h"
#include "core/terrain/fill_voids.h"
#include "core/terrain/slope.h"
#include "core/terrain/statistics.h"

namespace arete {
namespace {

constexpr std::int64_t longest_overview = 1024;

/// Looks at the level that is about as large as the overview, or the base.
SceneFacts survey(const SamplePyramid& pyramid, CellSize cell, const Overview& overview) {
  int level = pyramid.base();
  while (level + 1 < pyramid.levels() && std::max(pyramid.size(level).width, pyramid.size(level).height) > longest_overview) ++level;
  const Size size = pyramid.size(level);
  Raster<TerrainSample> samples(size.width, size.height);
  pyramid.read(level, {0, 0, size.width, size.height}, samples.view());
  const double step_x = 2 * cell.x_m * static_cast<double>(std::int64_t{1} << level), step_y = 2 * cell.y_m * static_cast<double>(std::int64_t{1} << level);
  SceneFacts facts;
  std::vector<float> land, slopes;
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) {
      const TerrainSample& here = samples(x, y);
      facts.has_voids |= here.valid < 1;
      facts.has_water |= here.water > 0.5f;
      if (here.valid < 0.5f || here.water > 0.5f) continue;
      land.push_back(here.smooth);
      if (x == 0 || y == 0 || x + 1 == size.width || y + 1 == size.height) continue;
      const double east = (samples(x + 1, y).smooth - samples(x - 1, y).smooth) / step_x;
      const double north = (samples(x, y - 1).smooth - samples(x, y + 1).smooth) / step_y;
      slopes.push_back(static_cast<float>(std::hypot(east, north)));
    }
  facts.low_m = overview.low_m;
  facts.high_m = overview.high_m;
  facts.ramp_low_m = land.empty() ? facts.low_m : percentile(land, 0.001);
  facts.ramp_high_m = land.empty() ? facts.high_m : percentile(land, 0.999);
  // The steepest tenth of gentle terrain looks like 20 degrees.
  if (!slopes.empty()) facts.exaggeration = exaggeration_for(percentile(slopes, 0.9), 20, 6);
  if (!slopes.empty()) facts.steepest_deg = slope_scale_deg(std::atan(static_cast<double>(percentile(slopes, 0.99))) * 180 / M_PI);
  return facts;
}

}  // namespace

std::unique_ptr<TerrainScene> prepare_scene(const RasterSource& source, CellSize cell, const SceneOptions& options, Progress& progress) {
  const Size size = source.size();
  if (size.width < 2 || size.height < 2)
    throw Error(ErrorKind::input, "cannot draw terrain of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                                      " cells in perspective: it takes 2 x 2 at least");
  auto scene = std::make_unique<TerrainScene>();
  const auto blocks = [](std::int64_t cells) { return (cells + longest_overview - 1) / longest_overview; };
  const int base = measured_level(source, options.measured_cells);
  if (base == 0) {
    scene->overview = make_overview(source, blocks(size.width), blocks(size.height), options.threads, progress);
  } else {
    const SourceLevel coarse(dynamic_cast<const LevelSource&>(source), base);
    scene->overview = make_overview(coarse, blocks(coarse.size().width), blocks(coarse.size().height), options.threads, progress);
    scene->overview.across <<= base;
    scene->overview.down <<= base;
  }
  if (scene->overview.valid == 0) throw Error(ErrorKind::input, "cannot draw terrain in perspective: no cell is valid");
  Raster<float>& heights = scene->overview.cells;
  if (std::all_of(heights.data(), heights.data() + heights.size().cells(), is_void)) {
    // Valid cells so sparse that each block is mostly void.
    std::fill(heights.data(), heights.data() + heights.size().cells(), static_cast<float>(scene->overview.low_m));
  }
  fill_voids(heights.view());
  scene->pyramid = std::make_unique<SamplePyramid>(source, scene->overview, options.memory_bytes / 4 * 3, options.measured_cells, options.threads, progress);
  scene->facts = survey(*scene->pyramid, cell, scene->overview);
  if (options.exaggeration > 0) scene->facts.exaggeration = options.exaggeration;
  if (options.steepest_deg) scene->facts.steepest_deg = *options.steepest_deg;
  if (options.ramp_range_m) scene->facts.ramp_low_m = (*options.ramp_range_m)[0], scene->facts.ramp_high_m = (*options.ramp_range_m)[1];
  scene->tree = build_quadtree(*scene->pyramid, options.threads, progress);
  scene->placement = {cell, scene->facts.exaggeration, 0, options.walls, options.walls && scene->facts.has_voids};
  light_scene(*scene, scene->facts.exaggeration, options.sun_azimuth_deg, options.sun_elevation_deg, options.threads);
  return scene;
}

void light_scene(TerrainScene& scene, double exaggeration, double sun_azimuth_deg, double sun_elevation_deg, int threads) {
  const bool same_heights = scene.facts.exaggeration == exaggeration && scene.light.sky.size().cells() > 0;
  scene.facts.exaggeration = scene.placement.exaggeration = exaggeration;
  const CellSize cell = scene.placement.cell;
  const Size size = scene.tree.size;
  const double low = scene.facts.low_m * exaggeration, high = scene.facts.high_m * exaggeration;
  const double longest = std::max(static_cast<double>(size.width - 1) * cell.x_m, static_cast<double>(size.height - 1) * cell.y_m);
  scene.placement.base = low - std::max(0.15 * (high - low), 0.015 * longest);
  const CellSize block{cell.x_m * static_cast<double>(scene.overview.across), cell.y_m * static_cast<double>(scene.overview.down)};
  SkyLightOptions options{.sun_azimuth_deg = sun_azimuth_deg, .sun_elevation_deg = sun_elevation_deg, .exaggeration = exaggeration, .threads = threads};
  if (same_heights) options.directions = 1;
  SkyLight light = measure_sky_light(scene.overview.cells.view(), block, options);
  scene.light.sun = std::move(light.sun);
  if (!same_heights) scene.light.sky = std::move(light.sky);
}

}  // namespace arete
