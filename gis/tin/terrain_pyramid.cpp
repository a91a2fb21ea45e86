#include "gis/tin/terrain_pyramid.h"

#include <algorithm>
#include <utility>

#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr int points = terrain_grid_cells + 1;

/// Gives the parent the points that lie on it too.
void thin_into(Raster<float>& parent, const TerrainTileId& tile, const Raster<float>& grid) {
  // Counted from the north-western corner of the parent, in points of the child's level.
  const int left = tile.x & 1 ? terrain_grid_cells : 0, top = tile.y & 1 ? 0 : terrain_grid_cells;
  for (int row = top % 2; row < points; row += 2)
    for (int column = left % 2; column < points; column += 2) {
      const float height = grid(column, row);
      if (!is_void(height)) parent((left + column) / 2, (top + row) / 2) = height;
    }
}

}  // namespace

/// One walk.
struct TerrainPyramid::Run {
  using Key = std::tuple<int, std::int64_t, std::int64_t>;

  const TerrainPyramid& pyramid;
  const Work& work;
  const Collect& collect;
  Progress& progress;
  std::vector<TerrainTileId> leaves{}, closed{};
  std::map<Key, Raster<float>> waiting{};  // grids of parents

  void descend(const TerrainTileId& tile) {
    const TerrainTileRange& deepest = pyramid.deepest_;
    const int up = deepest.level - tile.level;
    if (tile.x < deepest.x0 >> up || tile.x > deepest.x1 >> up || tile.y < deepest.y0 >> up || tile.y > deepest.y1 >> up) return;
    if (up == 0) {
      leaves.push_back(tile);
      if (leaves.size() == batch) flush();
      return;
    }
    for (const std::int64_t y : {2 * tile.y, 2 * tile.y + 1})
      for (const std::int64_t x : {2 * tile.x, 2 * tile.x + 1}) descend({tile.level + 1, x, y});
    closed.push_back(tile);
  }

  void finish(const std::vector<TerrainTileId>& tiles, std::vector<TerrainGrid>& grids) {
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      if (grids[i].heights.size().cells() == 0) continue;
      collect(i, tiles[i]);
    }
  }

  void thin(const TerrainTileId& tile, const Raster<float>& grid) {
    if (tile.level == 0) return;
    Raster<float>& parent = waiting[{tile.level - 1, tile.x >> 1, tile.y >> 1}];
    if (parent.size().cells() == 0) parent = Raster<float>(points, points, void_value);
    thin_into(parent, tile, grid);
  }

  /// Grids are thinned before they are worked on, which may fill them.
  void flush() {
    std::vector<TerrainGrid> grids(leaves.size());
    parallel_for(static_cast<std::int64_t>(leaves.size()), pyramid.threads_, [&](std::int64_t i) { grids[i] = pyramid.sampler_.sample(leaves[i]); });
    process(leaves, grids);
    progress.advance(static_cast<std::int64_t>(leaves.size()));
    leaves.clear();
    std::stable_sort(closed.begin(), closed.end(), [](const TerrainTileId& a, const TerrainTileId& b) { return a.level > b.level; });
    for (std::size_t first = 0; first < closed.size();) {
      std::vector<TerrainTileId> tiles;
      std::vector<TerrainGrid> parents;
      const int level = closed[first].level;
      for (; first < closed.size() && closed[first].level == level && tiles.size() < batch; ++first) {
        const auto found = waiting.find({level, closed[first].x, closed[first].y});
        if (found == waiting.end()) continue;
        tiles.push_back(closed[first]);
        parents.push_back({std::move(found->second), {}});
        waiting.erase(found);
      }
      process(tiles, parents);
    }
    closed.clear();
  }

  void process(const std::vector<TerrainTileId>& tiles, std::vector<TerrainGrid>& grids) {
    for (std::size_t i = 0; i < tiles.size(); ++i)
      if (grids[i].heights.size().cells() > 0) thin(tiles[i], grids[i].heights);
    parallel_for(static_cast<std::int64_t>(tiles.size()), pyramid.threads_, [&](std::int64_t i) {
      if (grids[i].heights.size().cells() > 0) work(static_cast<std::size_t>(i), tiles[i], grids[i]);
    });
    finish(tiles, grids);
  }
};

void TerrainPyramid::walk(const Work& work, const Collect& collect, Progress& progress) {
  Run run{*this, work, collect, progress};
  for (std::int64_t x = deepest_.x0 >> deepest_.level; x <= deepest_.x1 >> deepest_.level; ++x) run.descend({0, x, 0});
  run.flush();
}

}  // namespace arete
