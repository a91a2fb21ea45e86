#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/support/progress.h"
#include "gis/mesh/mesh.h"

namespace arete {

/// How the triangles of a mesh hang together, by the indices of their vertices; coordinates do not count.
struct MeshTopology {
  std::int64_t edges = 0;
  std::int64_t border_edges = 0;        ///< of one triangle only
  std::int64_t non_manifold_edges = 0;  ///< of three triangles or more, or of two that run along them in the same direction
  std::int64_t unused_vertices = 0;     ///< of no triangle
  /// Parts that share no vertex. Nullopt where they were not counted: 4 bytes per vertex exceed the memory.
  std::optional<std::int64_t> components;
};

/// An edge that one triangle has, from its one vertex to the next, counter-clockwise.
using BorderEdge = std::array<std::int64_t, 2>;

/// A triangle that names a vertex twice has no edges. The border edges, where asked for, come in the order of their lower vertex, then
/// of the higher. Edges are sorted in passes of memory_bytes / 2 (8 bytes per triangle and edge), each pass reading all triangles;
/// a bit per vertex and the border come on top. Throws Error{input} where a triangle names a vertex that the mesh does not have.
MeshTopology mesh_topology(const MeshSource& mesh, std::int64_t memory_bytes, Progress& progress, std::vector<BorderEdge>* border = nullptr);

}  // namespace arete
