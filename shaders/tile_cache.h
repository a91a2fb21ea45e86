#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "shaders/sample_pyramid.h"
#include "shaders/terrain_quadtree.h"

namespace arete {

/// A tile holds the samples of 4 x 4 nodes of a level.
inline constexpr int tile_cells = 4 * node_cells, tile_samples = tile_cells + 1;

/// Tiles of samples in two array textures, the longest unused ones replaced. The GL context must be current throughout.
class TileCache {
 public:
  /// Of as many layers as fit in the budget, 16 at least; the pyramid must outlive the cache.
  TileCache(const SamplePyramid& pyramid, std::int64_t memory_bytes, int threads);
  ~TileCache();
  TileCache(const TileCache&) = delete;
  TileCache& operator=(const TileCache&) = delete;

  /// Where the samples of a patch are.
  struct Place {
    std::int32_t layer = 0;
    bool holed = false;  ///< the tile has void samples
  };
  /// How many of the first patches have their tiles on the GPU together; loads those that are missing. `places` gets one per patch.
  /// At least one patch of a span that is not empty.
  std::size_t load(std::span<const TerrainPatch> patches, std::vector<Place>& places);
  /// Whether the tiles of all these patches fit together.
  bool holds(std::span<const TerrainPatch> patches) const;
  /// Twice as many layers; all are empty then.
  void grow();

  /// By layer: column and row of the first sample, level.
  std::vector<std::array<std::int32_t, 4>> table() const;
  unsigned heights() const { return heights_; }  ///< RG32F: height, validity
  unsigned shapes() const { return shapes_; }    ///< RGBA32F: height, its change per column and per row of the DEM, water; all smoothed
  std::int64_t loaded() const { return loaded_; }

 private:
  struct Key {
    std::int32_t level, y, x;
    auto operator<=>(const Key&) const = default;
  };
  struct Slot {
    Key key{-1, 0, 0};
    std::int64_t used = 0;
    bool holed = false;
  };
  struct Tile;
  static Key key_of(const TerrainPatch& patch);
  void make_textures(std::size_t layers);
  void read(const Key& key, Tile& tile) const;
  void upload(const std::vector<std::int32_t>& slots);

  const SamplePyramid& pyramid_;
  int threads_;
  unsigned heights_ = 0, shapes_ = 0;
  std::vector<Slot> slots_;
  std::map<Key, std::int32_t> where_;
  std::int64_t time_ = 0, loaded_ = 0;
};

}  // namespace arete
