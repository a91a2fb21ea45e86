#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/support/progress.h"
#include "gis/mesh/mesh.h"

namespace arete {

inline constexpr std::int64_t mesh_block = 65536;

/// Calls visit(first, vertices) for blocks of vertices from the first to the last.
template <class Visit>
void for_vertex_blocks(const MeshSource& mesh, Progress& progress, const Visit& visit) {
  std::vector<MeshVertex> block;
  for (std::int64_t first = 0; first < mesh.vertices(); first += mesh_block) {
    block.resize(static_cast<std::size_t>(std::min(mesh_block, mesh.vertices() - first)));
    mesh.read_vertices(first, block);
    visit(first, std::span<const MeshVertex>(block));
    progress.advance(static_cast<std::int64_t>(block.size()));
  }
}

/// Calls visit(first, triangles) for blocks of triangles from the first to the last.
template <class Visit>
void for_triangle_blocks(const MeshSource& mesh, Progress& progress, const Visit& visit) {
  std::vector<MeshTriangle> block;
  for (std::int64_t first = 0; first < mesh.triangles(); first += mesh_block) {
    block.resize(static_cast<std::size_t>(std::min(mesh_block, mesh.triangles() - first)));
    mesh.read_triangles(first, block);
    visit(first, std::span<const MeshTriangle>(block));
    progress.advance(static_cast<std::int64_t>(block.size()));
  }
}

}  // namespace arete
