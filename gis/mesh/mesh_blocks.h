#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "gis/mesh/mesh.h"

namespace arete {

/// How many vertices or triangles are held at a time.
inline constexpr std::int64_t mesh_block = 65536;

/// Calls visit(first, vertices) for all vertices of a mesh, in order, by blocks.
template <class Visit>
void for_vertex_blocks(const MeshSource& mesh, const Visit& visit) {
  std::vector<MeshVertex> block;
  for (std::int64_t first = 0; first < mesh.vertices(); first += mesh_block) {
    block.resize(static_cast<std::size_t>(std::min(mesh_block, mesh.vertices() - first)));
    mesh.read_vertices(first, block);
    visit(first, std::span<const MeshVertex>(block));
  }
}

/// The same for its triangles.
template <class Visit>
void for_triangle_blocks(const MeshSource& mesh, const Visit& visit) {
  std::vector<MeshTriangle> block;
  for (std::int64_t first = 0; first < mesh.triangles(); first += mesh_block) {
    block.resize(static_cast<std::size_t>(std::min(mesh_block, mesh.triangles() - first)));
    mesh.read_triangles(first, block);
    visit(first, std::span<const MeshTriangle>(block));
  }
}

}  // namespace arete
