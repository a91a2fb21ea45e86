#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"

namespace arete {

struct TerrainTilesOptions {
  double max_error_m = 1;   ///< above 0, at the deepest level
  bool fill = false;        ///< the deepest level too has ground at height 0 where the raster has none; else holes
  int passes = 3;           ///< of simplification
  int threads = 0;
  std::string name;         ///< of the set, one line
};

/// What one level is made of.
struct TerrainLevelReport {
  double bound_m = 0;
  double height_step_m = 0;
  double max_error_m = 0;       ///< deepest level: over the cells; others: over the points of their grid
  std::int64_t tiles = 0, triangles = 0, vertices = 0, bytes = 0;
};

struct TerrainTilesReport {
  std::vector<TerrainLevelReport> levels;  ///< from level 0
  std::int64_t cells = 0;                  ///< valid ones, all compared
  double max_error_m = 0, rmse_m = 0;      ///< over the cells, at the deepest level, of the tiles as they are stored
  bool ellipsoidal = false;                ///< heights were brought above the ellipsoid; else they are as the raster says them
};

/// Writes a set of quantized-mesh tiles for Cesium into an empty folder: z/x/y.terrain (not compressed), and layer.json at last.
///
/// Guarantees: 1. at the deepest level the centre of every valid cell of the raster lies in or on a triangle whose height there, linear
/// in longitude and latitude between the vertices as they are stored, is within the bound; checked of each tile. 2. Tiles of a level
/// have the same vertices on their common sides, bit for bit in place and height: steps of height are powers of two. 3. Each
/// level above has twice the bound of the level below (or what 15 bits can hold), over every point of its grid: each second one of
/// the level below. 4. Unless filled, no centre of a void cell is covered at the deepest level. Above, and on level 0 everywhere, what the
/// raster leaves void lies at height 0, because Cesium draws nothing where a tile has a hole. 5. The same bytes for any number
/// of threads.
///
/// Reads the raster twice by tiles; holds about 64 tiles with their grids. Throws Error{input} as GlobePlacement and
/// deepest_terrain_level, and where no cell is valid; Error{usage} where 15 bits cannot hold the bound, saying the smallest that they can;
/// Error{disk}, Error{interrupted}.
TerrainTilesReport write_terrain_tiles(const RasterSource& raster, const GeoReference& geo, const std::string& folder,
                                       const TerrainTilesOptions& options, Progress& progress);

}  // namespace arete
