#pragma once

#include "gis/mesh/check_mesh.h"
#include "gis/mesh/topology.h"
#include "tools/info.h"

namespace arete::tools {

/// How triangles hang together: "53,284 edges, 600 of them on the border; manifold; 1 part".
FileReport describe_topology(const MeshTopology& topology);

/// A mesh against its DEM.
FileReport describe_mesh_errors(const MeshErrors& errors, const MeshCheckOptions& options);

/// 1234567 as "1,234,567".
std::string grouped(std::int64_t count);

}  // namespace arete::tools
