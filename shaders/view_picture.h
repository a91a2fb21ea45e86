#pragma once

#include <array>
#include <optional>

#include "core/terrain/ground_style.h"
#include "shaders/scene_renderer.h"
#include "shaders/view_controls.h"

namespace arete {

/// One terrain, or two on the same ground; or meshes of it.
struct ViewedTerrains {
  SceneRenderer* first = nullptr;
  SceneRenderer* second = nullptr;
  Point3 offset_m = {0, 0, 0};  ///< from where the coordinates of the first begin to where those of the second do; z is 0
};

/// What a picture of them shows.
struct ViewedScene {
  ViewCamera camera;
  DrawMode mode = DrawMode::lit;
  GroundStyle style;
  ViewLayout layout = ViewLayout::first;
  double divider = 0.5;  ///< of the swipe: the first to its left, the second to its right
};

/// The picture that each terrain gets in a picture of that size: half of it side by side.
Size picture_of_one(ViewLayout layout, Size picture);

/// Draws what the layout shows of each terrain.
std::array<std::optional<Frame>, 2> draw_terrains(const ViewedTerrains& terrains, const ViewedScene& scene, Size picture);

/// Puts them together, with a line of `line_px` pixels between them. The counts are sums.
Frame compose_view(const std::array<std::optional<Frame>, 2>& frames, const ViewedScene& scene, Size picture, std::int64_t line_px);

}  // namespace arete
