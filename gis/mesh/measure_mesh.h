#pragma once

#include <optional>

#include "core/support/progress.h"
#include "gis/mesh/mesh.h"

namespace arete {

/// How large a mesh is.
struct MeshMeasures {
  MeshBounds bounds;           ///< in the units of the mesh; zeros where it has no vertices
  double low_m = 0, high_m = 0;  ///< of z, in metres
  /// Sum of the areas of the triangles seen from above: projected coordinates by the linear unit of the CRS, without a CRS taken as metres;
  /// longitudes and latitudes on the ellipsoid, sides straight in the cylindrical equal-area projection. Geocentric coordinates: the
  /// area of the triangles in space.
  double area_m2 = 0;
};

/// Reads vertices and triangles once, by blocks. Throws Error{input} where a triangle names a vertex that the mesh does not have.
MeshMeasures measure_mesh(const MeshSource& mesh, const MeshFrame& frame, Progress& progress);

}  // namespace arete
