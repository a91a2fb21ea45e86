#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gis/mesh/mesh.h"
#include "gis/mesh/mesh_store.h"

namespace arete {

/// What a writer is told beside the mesh.
struct MeshWriteOptions {
  std::string title;             ///< what the mesh is, one line, for the formats that have room for it
  std::string texture;           ///< a PNG or JPEG beside the output that is draped over the bounds of the mesh; empty: none
  MeshBounds texture_bounds;     ///< where the corners of the picture lie (x and y only), in the plane of the mesh
  bool normals = false;          ///< write a normal per vertex, in the formats that hold one
  bool compress = false;         ///< Draco, in glTF
  std::int64_t memory_bytes = 256 << 20;
};

/// How far a format moves a vertex that is given to it: the largest distance along x or y, and along z, in the units of the mesh.
/// 0: coordinates come back as they were given.
struct MeshRounding {
  double horizontal = 0;
  double vertical = 0;
};

/// A format of meshes. A path belongs to the first format that has its extension.
struct MeshFormat {
  std::string name;                     ///< "PLY"
  std::vector<std::string> extensions;  ///< lower case, with the dot
  std::string description;              ///< one line for --help and the manual
  bool metric = false;                  ///< its readers take x, y and z for one unit, metres: no longitude and latitude
  bool holds_normals = false, holds_texture = false;
  /// How far it moves the vertices of a mesh within these bounds.
  MeshRounding (*rounding)(const MeshBounds& bounds, const MeshWriteOptions& options) = nullptr;
  /// Writes the mesh at `path`, and its side files (offsets, .prj, materials) beside it, in a folder where nobody else looks: the
  /// caller moves all of them to their place (StagedFiles). The same mesh gives the same bytes. Throws Error{disk} where writing
  /// fails, Error{format} where the format cannot hold this mesh, saying its limit.
  void (*write)(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) = nullptr;
  std::vector<std::string> side_endings = {};  ///< of the side files that it may write, after the stem: ".prj"; but pictures
};

/// All formats that can be written, in the order in which they are listed to the user.
const std::vector<MeshFormat>& mesh_formats();

/// By the extension of the path. Throws Error{format} that lists the extensions where there is none.
const MeshFormat& mesh_format_of(const std::string& path);

/// A mesh that was read from a file: coordinates as the file states them, offsets applied.
struct MeshFile {
  MeshStore mesh;
  MeshFrame frame;
  std::string format;  ///< "PLY"
};

/// Reads any of the formats that are written here. Vertices that a format repeats (STL, DXF, TIN geometries) are made one where
/// their coordinates are equal. Throws Error{input} where the file is missing or damaged (what, where, expected, found),
/// Error{format} where it is no mesh of a known format.
MeshFile read_mesh(const std::string& path, const Scratch& scratch = {});

/// Whether read_mesh knows the extension.
bool is_mesh_path(const std::string& path);

}  // namespace arete
