#pragma once

#include <string>

#include "core/support/scratch.h"
#include "gis/mesh/mesh_format.h"

namespace arete {

/// glTF 2.0 (Khronos; ISO/IEC 12113:2022): `.glb`, one file, and `.gltf` with a `.bin` beside it.
///
/// glTF is in metres, y up, and holds float32 positions. So that they keep a millimetre anywhere on Earth, the mesh is cut into
/// nodes of at most 65,535 vertices, each of which lies within +-8,192 units (with Draco 4,096) of its translation, a double in JSON.
///  - x = east, y = up, z = -north; of a geocentric mesh x = X, y = Z, z = -Y.
///  - The root node has the translation of the whole mesh, a multiple of 16 units; the nodes below it have whole units. Both are exact
///    in float32 too, for the viewers that read them so. Who wants local coordinates zeroes the translation of the root.
///  - Where the units of the mesh are no metres, a node above scales them.
///  - All vertices are rounded to one grid for the whole mesh, whose step is a power of two (gltf_rounding) and exact in each node:
///    nodes have equal vertices where they meet.
///  - The root's extras hold {"georeference": {"crs_wkt", "vertical_unit", "metres_per_unit", "unit_metres", "offset", "axes"}}: unit_metres are
///    one unit of x, y and z in metres, offset is the translation of the root.
/// An edge longer than a node's reach (flat sea) is halved, in both its triangles, until it fits: such a mesh comes back with more
/// vertices. Triangles that have no area once rounded are left out, and so are vertices that no triangle names.

/// Half the step of the grid: at most 2^-12 units along each axis; with Draco, 2^-11.
MeshRounding gltf_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// By the extension of `path`. With `options.compress` the extension KHR_draco_mesh_compression is required of the reader.
/// Throws Error{format} where the CRS is geographic, a coordinate is beyond +-2^27 units or a .glb would pass 4 GiB, Error{input} where
/// the texture cannot be read or is neither PNG nor JPEG, Error{disk} where writing fails. Holds 100 MB beside the normals.
void write_gltf(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// All triangles of the scene of a .glb or .gltf, of whoever made it, in the plane of the mesh: x east, y north, z up, in the units that
/// the extras state, else metres. Vertices with equal coordinates are one. Throws Error{input} where it is damaged, Error{format}
/// where it requires an extension other than Draco, or holds lines, strips, sparse or quantised positions.
MeshFile read_gltf(const std::string& path, const Scratch& scratch = {});

}  // namespace arete
