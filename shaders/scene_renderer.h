#pragma once

#include <string>

#include "shaders/camera.h"
#include "shaders/frame.h"
#include "shaders/terrain_scene.h"

namespace arete {

/// Draws one scene from any camera, without a window: a terrain (terrain_renderer.h) or a mesh (mesh_renderer.h).
class SceneRenderer {
 public:
  virtual ~SceneRenderer() = default;

  virtual const SceneFacts& facts() const = 0;
  virtual std::string driver() const = 0;  ///< of OpenGL
  /// Of all that may be drawn; walls as well.
  virtual Box box() const = 0;
  /// Of the ground at (x east, y north) as the light sees it (blocks of the overview, voids filled), in exaggerated metres; outside, that of the border.
  virtual double ground_height(double x_m, double y_m) const = 0;

  /// Draws from now on with this exaggeration (> 0) and sun. See light_scene for its cost.
  virtual void relight(double exaggeration, double sun_azimuth_deg, double sun_elevation_deg) = 0;

  /// A picture of 1 x 1 to 16384 x 16384 pixels; throws Error{usage} beyond.
  virtual Frame draw(const Camera& camera, Size picture, DrawMode mode = DrawMode::lit) = 0;
};

}  // namespace arete
