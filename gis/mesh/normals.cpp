#include "gis/mesh/normals.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>

#include "gis/gdal_errors.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/vertex_cache.h"

namespace arete {
namespace {

constexpr double equator_m = 6378137;  // radius of WGS 84

/// Twice the area of the triangle, along its normal.
std::array<double, 3> area_vector(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c, double z_scale) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = (b.z - a.z) * z_scale;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = (c.z - a.z) * z_scale;
  return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

void add(std::array<float, 3>& sum, const std::array<double, 3>& vector) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] = static_cast<float>(sum[i] + vector[i]);
}

std::array<float, 3> unit(const std::array<float, 3>& sum) {
  const double x = sum[0], y = sum[1], z = sum[2];
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 1};
  return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

}  // namespace

std::vector<std::array<float, 3>> vertex_normals(const MeshSource& mesh, double z_scale) {
  std::vector<std::array<float, 3>> normals(static_cast<std::size_t>(mesh.vertices()), std::array<float, 3>{0, 0, 0});
  VertexCache vertices(mesh);
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& t : triangles) {
      const MeshVertex a = vertices[t[0]], b = vertices[t[1]], c = vertices[t[2]];
      const std::array<double, 3> area = area_vector(a, b, c, z_scale);
      for (const std::int64_t corner : t) add(normals[static_cast<std::size_t>(corner)], area);
    }
  });
  std::transform(normals.begin(), normals.end(), normals.begin(), unit);
  return normals;
}

double vertical_scale(const MeshFrame& frame) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (frame.crs_wkt.empty() || crs.importFromWkt(frame.crs_wkt.c_str()) != OGRERR_NONE) return frame.metres_per_unit;
  if (crs.IsCompound()) crs.StripVertical();
  const double metres = crs.IsGeographic() ? crs.GetAngularUnits() * equator_m : crs.GetLinearUnits();
  return metres > 0 ? frame.metres_per_unit / metres : frame.metres_per_unit;
}

}  // namespace arete
