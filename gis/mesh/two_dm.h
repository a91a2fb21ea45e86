#pragma once

#include "gis/mesh/mesh_format.h"

namespace arete {

/// 2DM (Aquaveo SMS, "2D Mesh Files *.2dm"): text, cards MESH2D, MESHNAME, E3T, ND; the CRS lies in `<name>.prj`. A vertical unit
/// other than the metre is a comment. Throws as MeshFormat::write.
void write_2dm(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// Nothing moves: 0.
MeshRounding two_dm_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// ND and E3T in any order; cards that are no geometry are skipped. Throws as read_mesh, and Error{input} at an element that is
/// no triangle.
MeshFile read_2dm(const std::string& path, const Scratch& scratch);

}  // namespace arete
