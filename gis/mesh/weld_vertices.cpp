#include "gis/mesh/weld_vertices.h"

#include <bit>

#include "core/support/random.h"

namespace arete {
namespace {

std::uint64_t hash(const MeshVertex& v) {
  return hash_position(std::bit_cast<std::uint64_t>(v.x), std::bit_cast<std::uint64_t>(v.y), std::bit_cast<std::uint64_t>(v.z));
}

}  // namespace

VertexWelder::Slot& VertexWelder::slot_of(std::vector<Slot>& slots, const MeshVertex& vertex) const {
  const std::size_t mask = slots.size() - 1;
  std::size_t place = static_cast<std::size_t>(hash(vertex)) & mask;
  while (slots[place].index >= 0 && !(slots[place].vertex == vertex)) place = (place + 1) & mask;
  return slots[place];
}

void VertexWelder::grow() {
  std::vector<Slot> larger(slots_.size() * 2);
  for (const Slot& slot : slots_)
    if (slot.index >= 0) slot_of(larger, slot.vertex) = slot;
  slots_.swap(larger);
}

std::int64_t VertexWelder::index_of(const MeshVertex& vertex) {
  // Adding 0 makes -0 to 0.
  const MeshVertex plain = {vertex.x + 0.0, vertex.y + 0.0, vertex.z + 0.0};
  Slot& found = slot_of(slots_, plain);
  if (found.index >= 0) return found.index;
  const std::int64_t index = mesh_.add(plain);
  found = {plain, index};
  if (++used_ * 10 > slots_.size() * 7) grow();
  return index;
}

}  // namespace arete
