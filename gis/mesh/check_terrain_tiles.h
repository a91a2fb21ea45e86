#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "gis/mesh/terrain_layer.h"

namespace arete {

/// A DEM that a set of tiles was made of.
struct TerrainTruth {
  const RasterSource& raster;
  const GeoReference& geo;
};

struct TerrainTilesCheck {
  std::int64_t tiles = 0, triangles = 0, vertices = 0;
  int levels = 0;
  std::int64_t valid_cells = 0;     ///< of the DEM; 0 without one
  std::int64_t compared_cells = 0;  ///< in or on a triangle of the deepest level
  double max_error_m = 0, rmse_m = 0;  ///< over the compared cells
  std::vector<std::string> faults;  ///< a line for each kind, with the number and the first place; empty: the set is sound
};

/// Checks a set of quantized-mesh tiles: layer.json; that each available tile is there and can be decoded, and so are its ancestors and both
/// tiles of level 0; that its triangles face the sky, hang together, and cover the whole tile (at the deepest level of a set with holes:
/// hang together); that neighbours of one level have the same vertices on their common side. With a DEM: that at the deepest
/// level the centre of each valid cell is covered, and of no void one (unless the set is filled), none inside two triangles, and each
/// within `max_error_m`, where that is given, by the height that is linear in longitude and latitude.
/// Shares no code with what makes tiles, but the change of CRS. Holds a few tiles a thread. Throws Error{input} where layer.json or a tile is missing
/// or damaged.
TerrainTilesCheck check_terrain_tiles(const std::string& folder, const std::optional<TerrainTruth>& dem, std::optional<double> max_error_m, int threads,
                                      Progress& progress);

}  // namespace arete
