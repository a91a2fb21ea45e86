#include "gis/mesh/vertex_cache.h"

#include <algorithm>

namespace arete {

VertexCache::VertexCache(const MeshSource& mesh)
    : mesh_(mesh),
      slot_of_(static_cast<std::size_t>((mesh.vertices() + block_vertices - 1) / block_vertices), std::int16_t{-1}) {}

void VertexCache::use(std::int64_t block) {
  std::int16_t& slot = slot_of_[static_cast<std::size_t>(block)];
  if (slot < 0) {
    // Not reachable under its number before it is whole: reading may throw.
    const std::size_t place = free_slot();
    Slot& taken = slots_[place];
    const std::int64_t first = block * block_vertices;
    taken.vertices.resize(static_cast<std::size_t>(std::min(block_vertices, mesh_.vertices() - first)));
    mesh_.read_vertices(first, taken.vertices);
    taken.block = block;
    slot = static_cast<std::int16_t>(place);
  }
  current_ = block;
  current_slot_ = static_cast<std::size_t>(slot);
  slots_[current_slot_].last_use = ++uses_;
}

std::size_t VertexCache::free_slot() {
  current_ = -1;
  if (slots_.size() < most_slots) {
    slots_.emplace_back();
    return slots_.size() - 1;
  }
  const auto oldest =
      std::min_element(slots_.begin(), slots_.end(), [](const Slot& a, const Slot& b) { return a.last_use < b.last_use; });
  if (oldest->block >= 0) slot_of_[static_cast<std::size_t>(oldest->block)] = -1;
  oldest->block = -1;
  return static_cast<std::size_t>(oldest - slots_.begin());
}

}  // namespace arete
