#pragma once

#include "gis/mesh/mesh.h"

namespace arete {

/// The box around all vertices; zeros for a mesh without any. Reads the vertices once. Throws as MeshSource.
MeshBounds mesh_bounds(const MeshSource& mesh);

}  // namespace arete
