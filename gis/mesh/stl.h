#pragma once

#include "gis/mesh/mesh_format.h"

namespace arete {

/// STL (3D Systems, "StereoLithography Interface Specification", 1989), binary: float32 coordinates, less an offset of whole
/// units (mesh_offset) that lies in the header and in `<name>_offset.xyz`; the CRS lies in `<name>.prj`. Each triangle repeats
/// its vertices. Throws Error{format} beyond 2^32 - 1 triangles, as MeshFormat::write else.
void write_stl(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// Half a unit in the last place of a float32 of the size of the largest coordinate less its offset, and what adding the offset
/// rounds in double: 0.5 mm at 8192 m to 16384 m.
MeshRounding stl_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// Binary or text. Vertices with equal coordinates become one. Throws as read_mesh.
MeshFile read_stl(const std::string& path, const Scratch& scratch);

}  // namespace arete
