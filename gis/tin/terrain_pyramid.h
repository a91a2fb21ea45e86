#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <tuple>
#include <vector>

#include "core/support/progress.h"
#include "gis/tin/terrain_grid.h"

namespace arete {

/// Walks over the tiles of all levels that have valid points, each with its grid: those of the deepest level are sampled, the others take
/// every second point of their children. Tiles come along a Z-order curve, parents soon after their children, so that few grids are
/// held: 64 tiles of the deepest level, and their ancestors.
class TerrainPyramid {
 public:
  TerrainPyramid(const TerrainSampler& sampler, const TerrainTileRange& deepest, int threads) : sampler_(sampler), deepest_(deepest), threads_(threads) {}

  /// Calls work(slot, tile, grid) on several threads, slot counting the tiles of a batch from 0; then collect(slot, tile) in order on one.
  using Work = std::function<void(std::size_t slot, const TerrainTileId& tile, TerrainGrid& grid)>;
  using Collect = std::function<void(std::size_t slot, const TerrainTileId& tile)>;
  static constexpr std::size_t batch = 64;
  void walk(const Work& work, const Collect& collect, Progress& progress);
  /// Tiles of the deepest level, with or without valid points.
  std::int64_t leaves() const { return (deepest_.x1 - deepest_.x0 + 1) * (deepest_.y1 - deepest_.y0 + 1); }

 private:
  struct Run;
  const TerrainSampler& sampler_;
  TerrainTileRange deepest_;
  int threads_;
};

}  // namespace arete
