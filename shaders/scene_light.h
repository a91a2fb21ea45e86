#pragma once

#include <array>
#include <cstdint>

#include "core/terrain/sky_light.h"
#include "shaders/camera.h"
#include "shaders/frame.h"
#include "shaders/terrain_scene.h"

namespace arete {

/// Sky and sun of a scene (light.glsl) as a texture; the caller deletes it.
unsigned make_light_texture(const SkyLight& light);
/// Where the sun stands, the ends of the ramps, and the colours of flat ground, water and air.
void set_scene_light(unsigned program, const SceneFacts& facts, const SceneOptions& options);

/// How ground is coloured (ground.glsl); gives the style back with the interval of contours as a number.
GroundStyle set_ground_style(unsigned program, const GroundStyle& style, const SceneFacts& facts, bool has_drape);
void set_highlights(unsigned program, Highlights highlights);

/// Nearest and farthest distance of a box.
std::array<double, 2> distances(const Box& box, const Point3& eye);
/// Distance ahead at which a picture of the box begins.
double near_of(const Box& box, const Point3& eye);
/// Haze over what is seen of a box from an eye.
void set_haze(unsigned program, const Box& box, const Point3& eye, double haze);

}  // namespace arete
