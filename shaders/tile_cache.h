#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "shaders/sample_pyramid.h"
#include "shaders/terrain_quadtree.h"

namespace arete {

/// Samples aside of a tile: those of a node, 65, and one around them for slopes.
inline constexpr int tile_samples = node_cells + 3;

/// Tiles of samples in one array texture (RGBA32F), the longest unused ones replaced. The GL context must be current throughout.
class TileCache {
 public:
  /// Of as many layers as fit in the budget, two at least; the pyramid must outlive the cache.
  TileCache(const SamplePyramid& pyramid, std::int64_t memory_bytes, int threads);
  ~TileCache();
  TileCache(const TileCache&) = delete;
  TileCache& operator=(const TileCache&) = delete;

  /// How many of the first patches have their tiles on the GPU together; loads those that are missing. `layers` gets one per patch.
  /// At least one patch of a span that is not empty.
  std::size_t load(std::span<const TerrainPatch> patches, std::vector<std::int32_t>& layers);
  unsigned texture() const { return texture_; }
  std::int64_t loaded() const { return loaded_; }

 private:
  struct Key {
    std::int32_t level, y, x;
    auto operator<=>(const Key&) const = default;
  };
  struct Slot {
    Key key{-1, 0, 0};
    std::int64_t used = 0;
  };
  void upload(const std::vector<std::int32_t>& slots);

  const SamplePyramid& pyramid_;
  int threads_;
  unsigned texture_ = 0;
  std::vector<Slot> slots_;
  std::map<Key, std::int32_t> where_;
  std::int64_t time_ = 0, loaded_ = 0;
};

}  // namespace arete
