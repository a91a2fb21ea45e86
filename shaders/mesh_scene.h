#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/overview.h"
#include "core/terrain/sky_light.h"
#include "shaders/terrain_scene.h"
#include "shaders/triangle_mesh.h"

namespace arete {

/// A vertex as the GPU gets it: units from the lowest corner of the mesh, whole numbers, so that what triangles share is one place to the last bit however far
/// away the eye is. z below 0: the foot of a wall.
struct MeshPlace {
  std::int32_t x = 0, y = 0, z = 0;
  std::uint32_t normal = 0;  ///< of the triangles around, weighted by area; octahedral, 2 x 16 bits, heights not exaggerated. Of walls: outwards
};

/// Triangles that lie together and follow each other; metres, heights not exaggerated.
struct MeshChunk {
  std::int64_t first = 0, count = 0;
  Box box;
  bool to_base = false;  ///< reaches down to the foot of the walls
};

/// All that drawing a mesh needs and that does not depend on the camera.
struct MeshScene {
  std::vector<MeshPlace> places;
  std::vector<std::array<std::uint32_t, 3>> triangles;          ///< the ground, walls around it, sides of holes, floor under holes
  std::int64_t first_wall = 0, first_side = 0, first_floor = 0;  ///< of the triangles
  std::vector<MeshChunk> chunks;                                ///< all of them, in order
  Box ground;                                                   ///< without walls, heights not exaggerated; its low corner is where units count from
  double unit_m = 1;                                            ///< a power of two; the mesh is at most 2^29 units wide, long and high
  Overview overview;                                            ///< of the surface seen from above, without voids; it covers the ground exactly
  CellSize block;                                               ///< a cell of it
  SkyLight light;
  SceneFacts facts;
  double base = 0;  ///< the foot of the walls, exaggerated metres
};

/// Memory that a mesh takes at most while it is prepared and while it is drawn, besides 40 MB for its overview. Of walls, four vertices and two triangles for
/// each side of the border.
std::int64_t mesh_bytes(std::int64_t vertices, std::int64_t triangles);

/// Throws Error{memory} before any work where mesh_bytes is more than options.memory_bytes.
void require_mesh_memory(std::int64_t vertices, std::int64_t triangles, const SceneOptions& options);

/// Triangles without area are left out; a mesh that is clockwise from above is turned over. Throws Error{input} where a vertex is not finite, a triangle names
/// one that is not there, or nothing is left that has an extent from west to east and from south to north; Error{memory} as above.
std::unique_ptr<MeshScene> prepare_mesh(TriangleMesh mesh, const SceneOptions& options, Progress& progress);

/// Another exaggeration or sun, as light_scene.
void light_mesh(MeshScene& scene, double exaggeration, double sun_azimuth_deg, double sun_elevation_deg, const SceneOptions& options);

}  // namespace arete
