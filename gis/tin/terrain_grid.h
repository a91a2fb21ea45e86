#pragma once

#include <cstdint>
#include <vector>

#include "core/terrain/raster_io.h"
#include "gis/globe_placement.h"
#include "gis/mesh/terrain_tile_errors.h"

namespace arete {

/// Cells along each side of a tile's grid. It divides 32767, so that the points of the grid are whole numbers of u and v, and it is odd:
/// of two tiles side by side every second point is a point of their parent.
inline constexpr int terrain_grid_cells = 217;
inline constexpr int quantized_per_cell = quantized_end / terrain_grid_cells;

/// A tile of Cesium's terrain (terrain_tile_rectangle). x may be below 0 or beyond the level's last column where a raster passes 180
/// degrees: columns repeat.
struct TerrainTileId {
  int level = 0;
  std::int64_t x = 0, y = 0;
};

/// Elevations over a tile.
struct TerrainGrid {
  Raster<float> heights;              ///< 218 x 218 points, the first at the north-western corner; metres, NaN void. Empty: no point is valid
  std::vector<TerrainPoint> centres;  ///< the centres of the raster's cells that lie on the tile, void ones too, row by row
};

/// Takes elevations of a raster at the points of the grids of tiles.
///
/// Guarantees: 1. a point on the side of two tiles has the same elevation in both. 2. Where no two centres of cells are less than
/// two points apart (deepest_terrain_level), each centre lies in a square of four points of its own, which lie in one plane through
/// its elevation, or are void as it is: the surface of the grid passes through all elevations, and covers the centres of valid
/// cells and no other. All other points are interpolated bilinearly; a point is void where it lies in a void cell or beyond
/// the raster. May be used by several threads.
class TerrainSampler {
 public:
  TerrainSampler(const RasterSource& raster, const GlobePlacement& placement) : raster_(raster), placement_(placement) {}
  /// Throws as RasterSource::read.
  TerrainGrid sample(const TerrainTileId& tile) const;

 private:
  const RasterSource& raster_;
  const GlobePlacement& placement_;
};

/// Tiles [x0, x1] x [y0, y1] of one level that may have points of a raster.
struct TerrainTileRange {
  int level = 0;
  std::int64_t x0 = 0, y0 = 0, x1 = -1, y1 = -1;
};

/// The first level whose grid has two points from each cell of the raster to the next, and its tiles. `extent`: what the raster covers.
/// Throws Error{input} where the raster lies about a pole or its cells are too fine or too far apart for any level up to 24.
TerrainTileRange deepest_terrain_level(const GlobePlacement& placement, Size size, TileRectangle& extent);

}  // namespace arete
