#pragma once

#include <cstdint>
#include <span>

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

/// Border edges that lie, end on end, where an earlier one does: two parts of a mesh that touch along it without hanging together. Exact;
/// heights do not count. Vertices of their own where two parts touch at a corner only are none. In memory: about 50 bytes per border edge.
/// `first` is the vertex that the edge leaves.
MeshFault find_cracks(std::span<const BorderEdge> border, RasterPoints& points);

}  // namespace arete
