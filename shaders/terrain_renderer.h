#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "shaders/camera.h"
#include "shaders/terrain_quadtree.h"
#include "shaders/terrain_scene.h"

namespace arete {

enum class DrawMode {
  lit,        ///< colours of heights, slopes or aspects under sun, sky and haze
  wireframe,  ///< the same with the sides of its triangles
  levels,     ///< a colour for each level of the quadtree
  coverage,   ///< white where there is terrain, transparent black elsewhere; as one sample of each pixel shows it
};

/// A picture with what it took.
struct Frame {
  Size size;
  std::vector<std::uint8_t> rgba;  ///< sRGB, row 0 at the top
  std::int64_t patches = 0;
  std::int64_t triangles = 0;      ///< of all patches together
  std::int64_t tiles_loaded = 0;   ///< that were not on the GPU already
};

/// Draws a terrain in perspective with hardware tessellation, without a window. Every vertex is a sample of the DEM, displaced in the
/// tessellation evaluation stage; the quadtree (terrain_quadtree.h) says which. Slopes are taken per pixel from samples about as far
/// apart as pixels. Light: a sun with soft shadows of the terrain, and the sky as far as the terrain lets it in
/// (core/terrain/sky_light.h, on 1024 x 1024 cells at most). A void is a hole whose edge lies halfway to the valid samples, through which the dark floor
/// of the block is seen;
/// water (sample_pyramid.h) is blue. No curvature of the Earth.
///
/// Guarantees: 1. the same driver gives the same bytes for the same calls, whatever `threads` is and was drawn before. 2. Meshes have no
/// cracks (terrain_quadtree.h). 3. Memory: memory_bytes, the quadtree, and a part of 1024 x 1024 pixels of the picture.
class TerrainRenderer {
 public:
  /// Reads the source two to three times by windows; it must outlive the renderer. `cell`: metric size of a cell.
  /// Throws Error{input} without a driver for OpenGL 4.5, where the raster is less than 2 x 2 cells, and where no cell is valid.
  TerrainRenderer(const RasterSource& source, CellSize cell, const SceneOptions& options, Progress& progress);
  ~TerrainRenderer();

  const SceneFacts& facts() const;
  std::string driver() const;  ///< of OpenGL
  /// Of all that may be drawn; walls as well.
  Box box() const;
  /// Of the ground at (x east, y north) as the light sees it (blocks of the overview, voids filled), in exaggerated metres; outside, that of the border.
  double ground_height(double x_m, double y_m) const;

  /// Draws from now on with this exaggeration (> 0) and sun. See light_scene for its cost.
  void relight(double exaggeration, double sun_azimuth_deg, double sun_elevation_deg);

  /// Colours the ground so from now on. At once.
  void restyle(const GroundStyle& style);
  /// How it is coloured; the interval of contours is a number.
  const GroundStyle& style() const;

  /// A picture of 1 x 1 to 16384 x 16384 pixels; throws Error{usage} beyond.
  Frame draw(const Camera& camera, Size picture, DrawMode mode = DrawMode::lit);

  /// The parts of draw(): which patches, and the picture of any patches.
  std::vector<TerrainPatch> select(const Camera& camera, Size picture) const;
  Frame draw(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode);
  /// The vertices that the GPU makes of patches, three per triangle: column, row, height in metres (walls: of the ground above).
  std::vector<std::array<float, 3>> evaluate(const std::vector<TerrainPatch>& patches);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
