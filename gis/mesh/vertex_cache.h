#pragma once

#include <cstdint>
#include <vector>

#include "gis/mesh/mesh.h"

namespace arete {

/// Vertices by index of a mesh that may be larger than memory: the blocks used last are kept, 25 MB of them. Fast where the
/// indices that follow each other lie close together, as those of the triangles of a mesh do. For one thread.
class VertexCache {
 public:
  explicit VertexCache(const MeshSource& mesh);
  /// `index` lies in [0, vertices). Throws as MeshSource.
  const MeshVertex& operator[](std::int64_t index) {
    const std::int64_t block = index / block_vertices;
    if (block != current_) use(block);
    return slots_[current_slot_].vertices[static_cast<std::size_t>(index % block_vertices)];
  }

 private:
  static constexpr std::int64_t block_vertices = 4096;
  static constexpr std::size_t most_slots = 256;
  struct Slot {
    std::int64_t block = -1;
    std::int64_t last_use = 0;
    std::vector<MeshVertex> vertices;
  };
  void use(std::int64_t block);
  std::size_t free_slot();

  const MeshSource& mesh_;
  std::vector<std::int16_t> slot_of_;  // per block; -1 where it is not kept
  std::vector<Slot> slots_;
  std::int64_t current_ = -1;
  std::size_t current_slot_ = 0;
  std::int64_t uses_ = 0;
};

}  // namespace arete
