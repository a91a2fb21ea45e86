#pragma once

#include <memory>
#include <string>

#include "core/support/progress.h"
#include "shaders/scene_renderer.h"
#include "shaders/triangle_mesh.h"

namespace arete {

/// Draws a mesh in perspective, as TerrainRenderer draws a DEM: its triangles themselves, under the same light, colours and haze. The border stands on
/// walls; a hole has sides down to the dark floor of the block. Sky and shadows are those of the surface seen from above, on 1024 x 1024 cells at most. Flat
/// triangles at or below 0 m are water.
///
/// Shading: facets of a TIN are no features of the ground, and triangles on both sides of a ridge are. A pixel is lit by the mean normal of the vertices (weighted
/// by area, interpolated) mixed with a quarter of the facet's own, so that one who comes close sees what the mesh is made of; where the facet is turned by more
/// than 35 degrees from the mean its own normal takes over, and from 60 degrees it is all that counts. Outlines, depth and lines are those of the triangles.
///
/// Lines are as wide in any distance, and fade where triangles are too small to be told apart. DrawMode::levels is for terrains: a mesh is lit.
///
/// Guarantees: 1. the same driver gives the same bytes for the same calls, whatever `threads` is and was drawn before. 2. Triangles that share a side leave no gap:
/// vertices are whole numbers of units of at most 2^-28 of the mesh's extent, taken from the eye before they are rounded to floats. 3. Memory: mesh_bytes,
/// 40 MB, and a part of 1280 x 1280 pixels of the picture.
class MeshRenderer final : public SceneRenderer {
 public:
  /// Throws Error{input} without a driver for OpenGL 4.5 and as prepare_mesh (mesh_scene.h), Error{memory} where the mesh does not fit
  /// options.memory_bytes or the driver's buffers.
  MeshRenderer(TriangleMesh mesh, const SceneOptions& options, Progress& progress);
  ~MeshRenderer() override;

  const SceneFacts& facts() const override;
  std::string driver() const override;
  Box box() const override;
  double ground_height(double x_m, double y_m) const override;
  void relight(double exaggeration, double sun_azimuth_deg, double sun_elevation_deg) override;
  void restyle(const GroundStyle& style) override;
  const GroundStyle& style() const override;

 private:
  /// Patches of the frame are groups of 2048 triangles that may be seen.
  Frame draw_parts(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const DrawnPart&)>& take) override;
  int threads() const override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
