#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shaders/camera.h"
#include "shaders/develop.h"
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

  /// Colours the ground so from now on. At once.
  virtual void restyle(const GroundStyle& style) = 0;
  /// How it is coloured; the interval of contours is a number.
  virtual const GroundStyle& style() const = 0;

  /// A picture of 1 x 1 to 16384 x 16384 pixels; throws Error{usage} beyond.
  Frame draw(const Camera& camera, Size picture, DrawMode mode = DrawMode::lit);
  /// The same from top to bottom, for pictures that need not be in memory and for other depths: `take` gets up to 1280 whole rows at a time. The
  /// frame that comes back has no pixels.
  Frame draw_rows(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const LightRows&)>& take);

 protected:
  /// Calls take() for the parts of a picture, row by row. The frame has no pixels.
  virtual Frame draw_parts(const Camera& camera, Size picture, DrawMode mode, Highlights highlights, const std::function<void(const DrawnPart&)>& take) = 0;
  virtual int threads() const = 0;
  /// Takes parts and writes them, made for the eye, into a picture that it makes when the first one comes.
  std::function<void(const DrawnPart&)> develop_into(std::vector<std::uint8_t>& rgba, Size picture) const;
};

}  // namespace arete
