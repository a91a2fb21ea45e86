#pragma once

#include <cstdint>
#include <vector>

#include "gis/mesh/mesh.h"
#include "gis/mesh/recent_blocks.h"

namespace arete {

/// Vertices by index of a mesh that may be larger than memory: the blocks used last are kept, 25 MB of them. Fast where the
/// indices that follow each other lie close together, as those of the triangles of a mesh do. For one thread.
class VertexCache {
 public:
  explicit VertexCache(const MeshSource& mesh);
  /// `index` lies in [0, vertices). Throws as MeshSource.
  const MeshVertex& operator[](std::int64_t index) {
    const std::int64_t block = index / block_vertices;
    if (block != current_) {
      current_ = -1;  // loading may throw
      vertices_ = blocks_.at(block).data();
      current_ = block;
    }
    return vertices_[index % block_vertices];
  }

 private:
  static constexpr std::int64_t block_vertices = 4096, kept_blocks = 256;
  RecentBlocks<std::vector<MeshVertex>> blocks_;
  std::int64_t current_ = -1;
  const MeshVertex* vertices_ = nullptr;  // of the current block
};

}  // namespace arete
