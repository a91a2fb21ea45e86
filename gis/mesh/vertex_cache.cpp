#include "gis/mesh/vertex_cache.h"

#include <algorithm>

namespace arete {

VertexCache::VertexCache(const MeshSource& mesh)
    : blocks_((mesh.vertices() + block_vertices - 1) / block_vertices, kept_blocks, [&mesh](std::int64_t index, std::vector<MeshVertex>& block) {
        const std::int64_t first = index * block_vertices;
        block.resize(static_cast<std::size_t>(std::min(block_vertices, mesh.vertices() - first)));
        mesh.read_vertices(first, block);
      }) {}

}  // namespace arete
