#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gis/mesh/quantized_mesh.h"

namespace arete {

/// A place on a tile and the elevation that is known there.
struct TerrainPoint {
  double u = 0, v = 0;   ///< as the vertices of the tile, 0..32767, with fractions
  double height_m = 0;   ///< NaN: there is no ground
};

/// A tile against points. A point within 1e-6 of a unit of u and v from an edge lies on the edge.
struct TerrainTileErrors {
  std::vector<double> error_m;      ///< per point: |height of the tile - height_m|; NaN where the point is in or on no triangle, or has no height
  double max_error_m = 0;
  double squares = 0;               ///< sum of the squared errors, m²
  std::int64_t compared = 0;        ///< points with a height, in or on a triangle
  std::int64_t uncovered = 0;       ///< points with a height in no triangle
  std::int64_t covered_voids = 0;   ///< points without height inside a triangle
  std::int64_t folds = 0;           ///< points inside two triangles
  std::int64_t clockwise = 0;       ///< triangles that face the ground, or have no area
};

/// Heights between vertices are linear in longitude and latitude. Shares no code with what makes tiles. Cost: triangles, and points times a
/// few triangles each.
TerrainTileErrors compare_terrain_tile(const QuantizedMesh& tile, std::span<const TerrainPoint> points);

/// Edges of triangles that no other triangle has from its other side, and that do not lie on a side of the tile (borders of voids); and
/// edges that more than two triangles have, or two from the same side.
struct TerrainTileEdges {
  std::int64_t inner_borders = 0;
  std::int64_t not_manifold = 0;
};
TerrainTileEdges find_tile_edges(const QuantizedMesh& tile);

/// A vertex on a side of a tile: how far along it, from south to north or west to east, and its height as the tile says it.
struct SideVertex {
  std::uint16_t at = 0;
  double height_m = 0;
  bool operator==(const SideVertex&) const = default;
};
/// The vertices of a side, one of mesh.west...; `along` is mesh.v for west and east, mesh.u for south and north. Ascending.
std::vector<SideVertex> side_vertices(const QuantizedMesh& tile, const std::vector<std::uint32_t>& side, const std::vector<std::uint16_t>& along);

}  // namespace arete
