#pragma once

#include "gis/mesh/mesh_format.h"

namespace arete {

/// OBJ (Wavefront, "Object Files", Advanced Visualizer appendix B1): text. Programs keep its coordinates as float32, so large
/// ones are written less an offset of whole units (mesh_offset), which lies in `<name>_offset.xyz` as Pix4D writes it and in a
/// comment; the CRS lies in `<name>.prj`. A texture adds vt, from options.texture_bounds, and `<name>.mtl`. Throws as
/// MeshFormat::write.
void write_obj(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// The texts are exact; the offset rounds as offset_rounding says: not at all for coordinates of projected systems.
MeshRounding obj_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// v and f are read, all else is skipped; the offset is added: of the comment, or of the file beside it. Throws as read_mesh, and
/// Error{input} at a face that is no triangle.
MeshFile read_obj(const std::string& path, const Scratch& scratch);

}  // namespace arete
