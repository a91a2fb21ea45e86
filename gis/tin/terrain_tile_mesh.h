#pragma once

#include <cstdint>

#include "gis/mesh/quantized_mesh.h"
#include "gis/tin/terrain_grid.h"

namespace arete {

/// What the tiles of a level are meshed with.
struct TerrainBound {
  double max_error_m = 1;
  double side_error_m = 1;       ///< of the sides of tiles, the same for all tiles of the level: neighbours agree
  double height_step_m = 1.0 / 1024;  ///< a power of two; heights of vertices are multiples of it in all tiles
  int passes = 3;                ///< of simplify()
  bool filled = false;           ///< the voids of the grid have been given heights
};

struct TerrainTileMesh {
  QuantizedMesh mesh;            ///< without triangles where no point is valid
  double grid_error_m = 0;       ///< the largest distance of a point of the grid
  double centre_error_m = 0;     ///< the largest distance of a centre, of the tile as it is stored
  double squares = 0;            ///< of these distances, m², each centre in one tile only
  std::int64_t centres = 0;      ///< valid ones, each in one tile only
  bool kept = false;             ///< centre_error_m is within the bound, each valid centre is covered and, unless filled, no void one
};

/// Meshes the grid of a tile (mesh_tile), quantises it without moving any vertex but those at the corners of voids (by half a unit of u
/// and v), and compares it with the centres; where the bound is not kept, again with the grid's squares about those centres in the mesh as
/// they are, and within a smaller bound, up to 20 times. On levels below 8 the tile is meshed by parts, so that its triangles follow the curve of the globe.
TerrainTileMesh mesh_terrain_tile(const TerrainTileId& tile, const TerrainGrid& grid, const TerrainBound& bound);

/// The smallest height step that a range of heights can have in 15 bits.
double least_height_step(double range_m);

}  // namespace arete
