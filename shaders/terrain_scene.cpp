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
SceneFacts survey(const SamplePyramid& pyramid, CellSize cell, const Overview& overview, const SceneOptions& options) {
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
  settle_facts(facts, land, slopes, options);
  return facts;
}

}  // namespace

void settle_facts(SceneFacts& facts, std::vector<float>& land, std::vector<float>& slopes, const SceneOptions& options) {
  facts.ramp_low_m = land.empty() ? facts.low_m : percentile(land, 0.001);
  facts.ramp_high_m = land.empty() ? facts.high_m : percentile(land, 0.999);
  if (!slopes.empty()) {
    // The steepest tenth of gentle terrain looks like 20 degrees.
    facts.exaggeration = exaggeration_for(percentile(slopes, 0.9), 20, 6);
    facts.steepest_deg = slope_scale_deg(std::atan(static_cast<double>(percentile(slopes, 0.99))) * 180 / M_PI);
  }
  if (options.exaggeration > 0) facts.exaggeration = options.exaggeration;
  if (options.steepest_deg) facts.steepest_deg = *options.steepest_deg;
  if (options.ramp_range_m) facts.ramp_low_m = (*options.ramp_range_m)[0], facts.ramp_high_m = (*options.ramp_range_m)[1];
}

double foot_of_walls(double low, double high, double longest_m) { return low - std::max(0.15 * (high - low), 0.015 * longest_m); }

void light_overview(SkyLight& light, RasterView<const float> heights, CellSize block, double exaggeration, double sun_azimuth_deg, double sun_elevation_deg,
                    bool sky_too, int threads) {
  SkyLightOptions options{.sun_azimuth_deg = sun_azimuth_deg, .sun_elevation_deg = sun_elevation_deg, .exaggeration = exaggeration, .threads = threads};
  if (!sky_too) options.directions = 1;
  SkyLight fresh = measure_sky_light(heights, block, options);
  light.sun = std::move(fresh.sun);
  if (sky_too) light.sky = std::move(fresh.sky);
}

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
  scene->facts = survey(*scene->pyramid, cell, scene->overview, options);
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
  scene.placement.base = foot_of_walls(scene.facts.low_m * exaggeration, scene.facts.high_m * exaggeration,
                                       std::max(static_cast<double>(size.width - 1) * cell.x_m, static_cast<double>(size.height - 1) * cell.y_m));
  const CellSize block{cell.x_m * static_cast<double>(scene.overview.across), cell.y_m * static_cast<double>(scene.overview.down)};
  light_overview(scene.light, scene.overview.cells.view(), block, exaggeration, sun_azimuth_deg, sun_elevation_deg, !same_heights, threads);
}

}  // namespace arete
