#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gis/mesh/quantized_mesh.h"

namespace arete {

/// Columns [x0, x1] and rows [y0, y1] of tiles, both ends included.
struct TerrainTileBlock {
  std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool operator==(const TerrainTileBlock&) const = default;
};

/// What layer.json says of a set of tiles.
struct TerrainLayer {
  std::string name;
  TileRectangle bounds;
  std::vector<std::vector<TerrainTileBlock>> available;  ///< per level, from 0
  bool filled = false;  ///< tiles of the deepest level have no holes
};

/// Few blocks that hold exactly these tiles (x, y), none twice: runs along the rows, joined where rows have the same.
std::vector<TerrainTileBlock> blocks_of(const std::set<std::pair<std::int64_t, std::int64_t>>& tiles);

/// The text of layer.json, as Cesium reads it: format quantized-mesh-1.0, scheme tms, projection EPSG:4326, no extensions.
std::string describe_layer(const TerrainLayer& layer);

/// The inverse. Throws Error{input} where the text is no JSON, no layer of quantized-mesh in EPSG:4326 and tms, has no available tiles, or
/// names tiles that its levels do not have; `name` stands for the file.
TerrainLayer parse_layer(const std::string& text, const std::string& name);

/// "folder/z/x/y.terrain".
std::string terrain_tile_path(const std::string& folder, int level, std::int64_t x, std::int64_t y);

}  // namespace arete
