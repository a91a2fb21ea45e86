#pragma once

#include <cstdint>
#include <vector>

#include "gis/mesh/mesh_builder.h"

namespace arete {

/// Makes vertices with equal coordinates one, for the formats that repeat them in every triangle. Their order is that in which
/// they come first. 0 and -0 are equal. Memory: 46 to 91 bytes per vertex, beside the mesh.
class VertexWelder {
 public:
  explicit VertexWelder(MeshBuilder& mesh) : mesh_(mesh), slots_(1024) {}
  /// The index of the vertex with these coordinates, which are finite; added to the mesh where there was none.
  std::int64_t index_of(const MeshVertex& vertex);

 private:
  struct Slot {
    MeshVertex vertex;
    std::int64_t index = -1;
  };
  Slot& slot_of(std::vector<Slot>& slots, const MeshVertex& vertex) const;
  void grow();

  MeshBuilder& mesh_;
  std::vector<Slot> slots_;  // open addressing; a power of two
  std::size_t used_ = 0;
};

}  // namespace arete
