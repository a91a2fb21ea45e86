#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shaders/camera.h"

namespace arete {

/// Triangles on the ground: vertices in metres from a point of reference, x east, y north, z up without exaggeration; three of them by index per triangle,
/// counter-clockwise from above.
struct TriangleMesh {
  std::vector<Point3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace arete
