#pragma once

#include "gis/mesh/mesh_format.h"

namespace arete {

/// DXF (Autodesk, "DXF Reference", release 12, which every CAD program reads): one 3DFACE per triangle on the layer TIN, its
/// fourth corner being the third; the title is a comment (999), the CRS lies in `<name>.prj`. Throws as MeshFormat::write.
void write_dxf(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// Nothing moves: 0.
MeshRounding dxf_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// By GDAL: the three-dimensional faces of a drawing of any release; all else is skipped. Vertices with equal coordinates become
/// one. Throws as read_mesh, and Error{input} at a face that is no triangle.
MeshFile read_dxf(const std::string& path, const Scratch& scratch);

}  // namespace arete
