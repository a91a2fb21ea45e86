#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/ground_style.h"
#include "core/terrain/overview.h"
#include "core/terrain/raster_io.h"
#include "core/terrain/sky_light.h"
#include "shaders/sample_pyramid.h"
#include "shaders/terrain_quadtree.h"

namespace arete {

/// A picture to be laid over the ground.
struct GroundPicture {
  Size size;
  std::vector<std::array<std::uint8_t, 4>> rgba;            ///< sRGB and opacity, row 0 at the top; along rows and columns of the DEM
  double left = 0, top = 0, width = 1, height = 1;          ///< what it covers, in cells of the DEM from the outer corner of the first
  CellSize cell = {1, 1};                                   ///< of the DEM, metres
};

struct SceneOptions {
  double exaggeration = 0;                         ///< of heights; 0: 1 for mountains, up to 6 for gentle terrain
  std::vector<std::array<std::uint8_t, 3>> ramp;   ///< sRGB colours from the lowest to the highest land; empty: grey
  std::vector<std::array<std::uint8_t, 3>> slope_ramp;   ///< from flat to the steepest; empty: grey
  std::vector<std::array<std::uint8_t, 3>> aspect_ramp;  ///< by the direction that ground faces, from north by east to north again; empty: grey
  std::array<std::uint8_t, 3> flat_colour = {180, 180, 180};  ///< of aspects where the ground is flat
  GroundStyle style;                               ///< at first
  std::shared_ptr<const GroundPicture> drape;      ///< shown where it is opaque, lightly lit; none: nothing. Sides up to 8192
  double sun_azimuth_deg = 315, sun_elevation_deg = 40;
  std::optional<double> steepest_deg;                 ///< where the colours of slopes end; none: as the facts say
  std::optional<std::array<double, 2>> ramp_range_m;  ///< heights of the ends of the ramp; none: as the facts say
  double haze = 0.15;                              ///< share of the far side's light that is haze, in [0, 1)
  bool walls = true;                               ///< the terrain is a block that stands on its walls
  SelectionOptions detail;
  int supersampling = 1;                           ///< 1 to 4: pixels aside that are averaged to one, besides 4 samples per pixel
  std::int64_t memory_bytes = std::int64_t{512} << 20;  ///< of samples kept and tiles on the GPU
  std::int64_t measured_cells = std::int64_t{1} << 22;  ///< sources with levels are read whole at the finest with at most so many cells (SamplePyramid)
  int threads = 0;
};

/// What the scene found in the terrain. Of a tree in levels, in the level that is read whole (SamplePyramid), which is smoother than the finest.
struct SceneFacts {
  double low_m = 0, high_m = 0;            ///< lowest and highest valid sample
  double ramp_low_m = 0, ramp_high_m = 0;  ///< ends of the colours: 0.1 and 99.9 % of the land
  double steepest_deg = 90;                ///< where the colours of slopes end
  double exaggeration = 1;
  bool has_voids = false, has_water = false;
};

/// All that drawing needs and that does not depend on the camera.
struct TerrainScene {
  Overview overview;  ///< without voids
  std::unique_ptr<SamplePyramid> pyramid;
  TerrainQuadtree tree;
  TerrainPlacement placement;
  SkyLight light;  ///< of the overview
  SceneFacts facts;
};

/// Reads the source, or the level that takes its place (SamplePyramid), by windows: once for the overview, once for the pyramid, and once more where not all samples stay in memory. The source
/// must outlive the scene. Throws Error{input} where the raster is less than 2 x 2 cells or no cell is valid.
std::unique_ptr<TerrainScene> prepare_scene(const RasterSource& source, CellSize cell, const SceneOptions& options, Progress& progress);

/// What suits land of those heights (metres) and slopes (metres per metre) where the options do not say: ends of colours, exaggeration, steepest slope.
void settle_facts(SceneFacts& facts, std::vector<float>& land, std::vector<float>& slopes, const SceneOptions& options);

/// Where walls end under ground from `low` to `high` (exaggerated metres) of that length.
double foot_of_walls(double low, double high, double longest_m);

/// Sun, and where `sky_too` sky, over an overview with cells of that size.
void light_overview(SkyLight& light, RasterView<const float> heights, CellSize block, double exaggeration, double sun_azimuth_deg, double sun_elevation_deg,
                    bool sky_too, int threads);

/// Another exaggeration or sun. Seconds at most: 17 visits of the cells of the overview, 2 where the exaggeration stays.
void light_scene(TerrainScene& scene, double exaggeration, double sun_azimuth_deg, double sun_elevation_deg, int threads);

}  // namespace arete
