#pragma once

#include <cstdint>
#include <span>

#include "core/support/progress.h"
#include "gis/mesh/raster_plane.h"
#include "gis/mesh/topology.h"

namespace arete {

/// How often something was found, and the first vertex or triangle where; -1: nowhere.
struct MeshFault {
  std::int64_t count = 0;
  std::int64_t first = -1;
  void add(std::int64_t index) {
    if (count++ == 0 || index < first) first = index;
  }
};

/// Vertices of border edges that lie inside another border edge, in the plane: cracks, and borders that touch themselves. Exact. Each
/// vertex counts once for each edge. In memory: about 60 bytes per border edge.
MeshFault find_t_junctions(std::span<const BorderEdge> border, RasterPoints& points);

/// Vertices at the column and row of an earlier one, whatever their heights. Exact. Sorts 8 bytes per vertex, in passes where they exceed
/// memory_bytes.
MeshFault find_duplicate_vertices(const RasterPoints& points, std::int64_t memory_bytes, Progress& progress);

}  // namespace arete
