#include "gis/mesh/mesh_bounds.h"

#include "gis/mesh/mesh_blocks.h"

namespace arete {

MeshBounds mesh_bounds(const MeshSource& mesh) {
  MeshBounds bounds;
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    if (first == 0) bounds = {vertices.front(), vertices.front()};
    for (const MeshVertex& v : vertices) {
      bounds.low = {std::min(bounds.low.x, v.x), std::min(bounds.low.y, v.y), std::min(bounds.low.z, v.z)};
      bounds.high = {std::max(bounds.high.x, v.x), std::max(bounds.high.y, v.y), std::max(bounds.high.z, v.z)};
    }
  });
  return bounds;
}

}  // namespace arete
