#pragma once

#include <memory>
#include <string>

#include "gis/mesh/mesh_format.h"
#include "shaders/scene_renderer.h"
#include "tools/command.h"
#include "tools/elevation_input.h"

namespace arete::tools {

/// What can be drawn in perspective, as it was read: a DEM, a tree (.sct) or a mesh.
struct SceneInput {
  std::string path;
  ElevationInput dem;               ///< no source: a mesh
  std::unique_ptr<MeshFile> mesh;   ///< null: a DEM
  /// Whose cells say where things are: the DEM's own, or a raster over the mesh.
  GeoReference geo;
  Size size;
  CellSize cell;

  bool is_mesh() const { return mesh != nullptr; }
};

/// Throws as open_elevations, read_mesh and mesh_plane.
SceneInput open_scene(const std::string& path, const DemReadOptions& options, const CommonOptions& common);

/// Metres from the first sample of one to that of another, where the coordinates of its renderer begin. 0 for a mesh, which is placed in the cells of the
/// first. Throws as place_in_cells.
Point3 offset_between(const SceneInput& first, const SceneInput& other);

/// A renderer of the input, which must outlive it; a mesh is placed in the cells of `frame` and is read no more. Throws as the renderers and RasterPlane, and
/// Error{input} where the mesh and `frame` share no ground.
std::unique_ptr<SceneRenderer> make_renderer(SceneInput& input, const SceneInput& frame, const SceneOptions& options, Progress& progress);

}  // namespace arete::tools
