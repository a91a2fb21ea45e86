#include "tools/scene_input.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gis/alignment.h"
#include "gis/geodesy.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_plane.h"
#include "gis/mesh/raster_plane.h"
#include "shaders/mesh_renderer.h"
#include "shaders/mesh_scene.h"
#include "shaders/terrain_renderer.h"
#include "tools/mesh_input.h"

namespace arete::tools {
namespace {

TriangleMesh place_mesh(const SceneInput& input, const SceneInput& frame, Progress& progress) {
  const MeshFile& file = *input.mesh;
  const RasterPlane plane(file.frame, frame.geo, 0);
  TriangleMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(file.mesh.vertices()));
  mesh.triangles.reserve(static_cast<std::size_t>(file.mesh.triangles()));
  progress.begin("Placing vertices", file.mesh.vertices());
  std::vector<RasterPoint> placed;
  const double east = frame.cell.x_m / static_cast<double>(cell_units), north = -frame.cell.y_m / static_cast<double>(cell_units);
  double left = INFINITY, right = -INFINITY, top = -INFINITY, bottom = INFINITY;
  for_vertex_blocks(file.mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    placed.resize(vertices.size());
    plane.place(first, vertices, placed);
    for (const RasterPoint& p : placed) {
      const Point3 at = {static_cast<double>(p.column) * east, static_cast<double>(p.row) * north, p.z};
      left = std::min(left, at[0]), right = std::max(right, at[0]), bottom = std::min(bottom, at[1]), top = std::max(top, at[1]);
      mesh.vertices.push_back(at);
    }
    progress.advance(static_cast<std::int64_t>(placed.size()));
  });
  progress.end();
  const double wide = static_cast<double>(frame.size.width) * frame.cell.x_m, high = static_cast<double>(frame.size.height) * frame.cell.y_m;
  if (&input != &frame && (right < 0 || left > wide || top < -high || bottom > 0))
    throw Error(ErrorKind::input, fmt::format("'{}' and '{}' share no ground", frame.path, input.path));
  for_triangle_blocks(file.mesh, [&](std::int64_t first, std::span<const MeshTriangle> triangles) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const auto index = [&](std::int64_t corner) {
        if (corner < 0 || corner >= file.mesh.vertices())
          throw Error(ErrorKind::input, fmt::format("triangle {} of '{}' names vertex {}, but there are only {}", first + static_cast<std::int64_t>(i),
                                                    input.path, corner, file.mesh.vertices()));
        return static_cast<std::uint32_t>(corner);
      };
      mesh.triangles.push_back({index(triangles[i][0]), index(triangles[i][1]), index(triangles[i][2])});
    }
  });
  return mesh;
}

}  // namespace

SceneInput open_scene(const std::string& path, const DemReadOptions& options, const CommonOptions& common) {
  SceneInput input;
  input.path = path;
  if (is_mesh_file(path)) {
    input.mesh = std::make_unique<MeshFile>(read_mesh(path, temporary_scratch(common, 4)));
    const MeshPlane plane = mesh_plane(input.mesh->mesh, input.mesh->frame);
    input.geo = plane.geo, input.size = plane.size, input.cell = plane.cell;
    return input;
  }
  input.dem = open_elevations(path, options, common.threads);
  input.geo = input.dem.geo;
  input.size = input.dem.source->size();
  input.cell = cell_size(input.geo, input.size);
  return input;
}

Point3 offset_between(const SceneInput& first, const SceneInput& other) {
  if (other.is_mesh()) return {0, 0, 0};
  const auto p = place_in_cells({first.path, first.geo, first.size}, {other.path, other.geo, other.size});
  const double column = p[0] + (p[1] + p[2]) / 2 - 0.5, row = p[3] + (p[4] + p[5]) / 2 - 0.5;
  return {column * first.cell.x_m, -row * first.cell.y_m, 0};
}

std::unique_ptr<SceneRenderer> make_renderer(SceneInput& input, const SceneInput& frame, const SceneOptions& options, Progress& progress) {
  if (!input.is_mesh()) return std::make_unique<TerrainRenderer>(*input.dem.source, input.cell, options, progress);
  require_mesh_memory(input.mesh->mesh.vertices(), input.mesh->mesh.triangles(), options);
  TriangleMesh mesh = place_mesh(input, frame, progress);
  input.mesh->mesh = MeshStore();
  return std::make_unique<MeshRenderer>(std::move(mesh), options, progress);
}

}  // namespace arete::tools
