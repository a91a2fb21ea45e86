#pragma once

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"
#include "gis/mesh/mesh.h"

namespace arete {

/// A raster that covers a mesh exactly and is in its CRS (of geocentric coordinates: in longitude and latitude), north up: what a mesh is drawn in, through
/// RasterPlane.
struct MeshPlane {
  GeoReference geo;
  Size size;
  CellSize cell;  ///< on the ground at the centre, as cell_size
};

/// Reads the vertices once. Throws Error{input} where the mesh has no extent from west to east and from south to north, and as RasterPlane.
MeshPlane mesh_plane(const MeshSource& mesh, const MeshFrame& frame);

}  // namespace arete
