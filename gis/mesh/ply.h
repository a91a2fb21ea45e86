#pragma once

#include "gis/mesh/mesh_format.h"

namespace arete {

/// PLY (Turk, "The PLY Polygon File Format", 1994): little endian, double x y z, float nx ny nz where normals are asked for,
/// faces as `uchar int vertex_indices` (`uchar uint` beyond 2^31 vertices). The title and the vertical unit are comments, the CRS
/// lies in a .prj beside it: programs stumble over richer headers. Throws Error{format} beyond 2^32 vertices, as
/// MeshFormat::write else.
void write_ply(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// Nothing moves: 0.
MeshRounding ply_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// Text or binary of either byte order, coordinates and indices of any type, `vertex_indices` or `vertex_index`; what else there
/// is is skipped. Throws as read_mesh, and Error{input} at a face that is no triangle.
MeshFile read_ply(const std::string& path, const Scratch& scratch);

}  // namespace arete
