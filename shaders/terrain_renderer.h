#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "shaders/scene_renderer.h"
#include "shaders/terrain_quadtree.h"

namespace arete {

/// Draws a terrain in perspective with hardware tessellation, without a window. Every vertex is a sample of the DEM (of a large tree, of the level that it is
/// drawn from: SamplePyramid), displaced in the tessellation evaluation stage; the quadtree (terrain_quadtree.h) says which. Slopes are taken per pixel from samples about as far
/// apart as pixels. Light: a sun with soft shadows of the terrain, and the sky as far as the terrain lets it in
/// (core/terrain/sky_light.h, on 1024 x 1024 cells at most). A void is a hole whose edge lies halfway to the valid samples, through which the dark floor
/// of the block is seen;
/// water (sample_pyramid.h) is blue. No curvature of the Earth.
///
/// Guarantees: 1. the same driver gives the same bytes for the same calls, whatever `threads` and memory_bytes are and whatever was drawn before. 2. Meshes have no
/// cracks (terrain_quadtree.h). 3. Memory: memory_bytes, the quadtree, 1280 rows of the picture, and what draw() gives back.
class TerrainRenderer final : public SceneRenderer {
 public:
  /// Reads the source two to three times by windows; it must outlive the renderer. `cell`: metric size of a cell.
  /// Throws Error{input} without a driver for OpenGL 4.5, where the raster is less than 2 x 2 cells, and where no cell is valid.
  TerrainRenderer(const RasterSource& source, CellSize cell, const SceneOptions& options, Progress& progress);
  ~TerrainRenderer() override;

  const SceneFacts& facts() const override;
  std::string driver() const override;
  Box box() const override;
  double ground_height(double x_m, double y_m) const override;
  void relight(double exaggeration, double sun_azimuth_deg, double sun_elevation_deg) override;
  void restyle(const GroundStyle& style) override;
  const GroundStyle& style() const override;
  using SceneRenderer::draw;
  /// The parts of draw(): which patches, and the picture of any patches.
  std::vector<TerrainPatch> select(const Camera& camera, Size picture) const;
  Frame draw(const std::vector<TerrainPatch>& patches, const Camera& camera, Size picture, DrawMode mode);
  /// The vertices that the GPU makes of patches, three per triangle: column, row, height in metres (walls: of the ground above).
  std::vector<std::array<float, 3>> evaluate(const std::vector<TerrainPatch>& patches);

 private:
  Frame draw_parts(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const DrawnPart&)>& take) override;
  int threads() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
