#pragma once

#include "shaders/terrain_scene.h"

namespace arete {

/// Textures of what colours the ground (ground.glsl). The GL context must be current; who calls deletes them.

/// The ramps of heights, slopes and aspects: a 1D array of 3 layers of linear light.
unsigned make_ramp_texture(const SceneOptions& options);

/// A picture and its levels (picture_atlas.h); sets the uniforms of the program that say where they are. Throws Error{input}
/// where the driver has no texture so large.
unsigned make_drape_texture(const GroundPicture& picture, unsigned program, int threads);

}  // namespace arete
