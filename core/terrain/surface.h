#pragma once

#include <cstdint>
#include <list>
#include <unordered_map>

#include "core/terrain/raster_io.h"

namespace arete {

/// The terrain as a function of the plane, in cells: the centre of the first cell is (0.5, 0.5), x grows east, y south.
struct SurfacePoint {
  double elevation_m = 0;  ///< NaN where void
  double per_cell_x = 0;   ///< derivatives, metres per cell
  double per_cell_y = 0;
};

/// Continuous with its first derivatives: bicubic through the cells' centres with Catmull-Rom weights (Keys, IEEE Trans. ASSP
/// 29, 1981, a = -1/2). Beyond the border the edge cells repeat. A point in a void cell, or outside the raster, is void; beside
/// voids the surface is continued with the elevation of the point's own cell.
/// Reads the source by tiles and keeps the last ones: points near one another cost about 50 ns. For one thread at a time.
class SurfaceSampler {
 public:
  /// `source` must outlive it.
  explicit SurfaceSampler(const RasterSource& source, std::size_t kept_tiles = 64) : source_(source), kept_tiles_(kept_tiles) {}
  SurfacePoint at(double x, double y);

 private:
  struct Tile {
    std::int64_t number = 0;
    Window window;
    Raster<float> cells;
  };
  const Tile& tile_of(std::int64_t column, std::int64_t row);

  const RasterSource& source_;
  std::size_t kept_tiles_;
  std::list<Tile> tiles_;  // the last used first
  std::unordered_map<std::int64_t, std::list<Tile>::iterator> by_number_;
};

}  // namespace arete
