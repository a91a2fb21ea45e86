#include "gis/mesh/measure_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include <GeographicLib/Ellipsoid.hpp>
#include <ogr_spatialref.h>

#include "core/support/error.h"
#include "gis/gdal_errors.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/recent_blocks.h"

namespace arete {
namespace {

constexpr std::int64_t block_vertices = 4096, kept_blocks = 512;

/// Coordinates in metres whose areas are those on the ground. Flat but for geocentric coordinates.
struct AreaPlane {
  std::function<MeshVertex(const MeshVertex&)> place;
  bool in_space = false;
};

AreaPlane area_plane(const MeshFrame& frame) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  const bool known = !frame.crs_wkt.empty() && crs.importFromWkt(frame.crs_wkt.c_str()) == OGRERR_NONE;
  if (known && crs.IsGeocentric()) return {[](const MeshVertex& v) { return v; }, true};
  if (known && crs.IsGeographic()) {
    const double degrees = crs.GetAngularUnits(nullptr) * 180 / M_PI, inverse_flattening = crs.GetInvFlattening();
    const GeographicLib::Ellipsoid ellipsoid(crs.GetSemiMajor(), inverse_flattening == 0 ? 0 : 1 / inverse_flattening);
    const double radius = std::sqrt(ellipsoid.Area() / (4 * M_PI));
    return {[=](const MeshVertex& v) {
      return MeshVertex{radius * v.x * degrees * M_PI / 180, radius * std::sin(ellipsoid.AuthalicLatitude(std::clamp(v.y * degrees, -90.0, 90.0)) * M_PI / 180), 0};
    }};
  }
  const double unit = known && crs.IsProjected() ? crs.GetLinearUnits() : 1;
  return {[unit](const MeshVertex& v) { return MeshVertex{v.x * unit, v.y * unit, 0}; }};
}

double area_of(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  return std::hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
}

double total_area(const MeshSource& mesh, const AreaPlane& plane, Progress& progress) {
  const std::int64_t count = mesh.vertices();
  RecentBlocks<std::vector<MeshVertex>> placed((count + block_vertices - 1) / block_vertices, kept_blocks, [&](std::int64_t index, std::vector<MeshVertex>& block) {
    block.resize(static_cast<std::size_t>(std::min(block_vertices, count - index * block_vertices)));
    mesh.read_vertices(index * block_vertices, block);
    std::transform(block.begin(), block.end(), block.begin(), plane.place);
  });
  double total = 0;
  for_triangle_blocks(mesh, [&](std::int64_t first, std::span<const MeshTriangle> triangles) {
    double sum = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      std::array<MeshVertex, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t vertex = triangles[i][k];
        if (vertex < 0 || vertex >= count)
          throw Error(ErrorKind::input, "triangle " + std::to_string(first + static_cast<std::int64_t>(i)) + " of the mesh names vertex " + std::to_string(vertex) +
                                            ", but there are only " + std::to_string(count));
        corners[k] = placed.at(vertex / block_vertices)[static_cast<std::size_t>(vertex % block_vertices)];
      }
      sum += area_of(corners[0], corners[1], corners[2]);
    }
    total += sum;
    progress.advance(static_cast<std::int64_t>(triangles.size()));
  });
  return total;
}

void enlarge(MeshBounds& bounds, const MeshVertex& v) {
  bounds.low = {std::min(bounds.low.x, v.x), std::min(bounds.low.y, v.y), std::min(bounds.low.z, v.z)};
  bounds.high = {std::max(bounds.high.x, v.x), std::max(bounds.high.y, v.y), std::max(bounds.high.z, v.z)};
}

}  // namespace

MeshMeasures measure_mesh(const MeshSource& mesh, const MeshFrame& frame, Progress& progress) {
  MeshMeasures measures;
  progress.begin("Measuring the mesh", mesh.vertices() + mesh.triangles());
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    if (first == 0) measures.bounds = {vertices[0], vertices[0]};
    for (const MeshVertex& v : vertices) enlarge(measures.bounds, v);
    progress.advance(static_cast<std::int64_t>(vertices.size()));
  });
  measures.low_m = measures.bounds.low.z * frame.metres_per_unit;
  measures.high_m = measures.bounds.high.z * frame.metres_per_unit;
  measures.area_m2 = total_area(mesh, area_plane(frame), progress);
  progress.end();
  return measures;
}

}  // namespace arete
