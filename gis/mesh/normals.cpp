#include "gis/mesh/normals.h"

#include <algorithm>
#include <cmath>

#include "gis/mesh/vertex_cache.h"

namespace arete {
namespace {

constexpr std::int64_t block_triangles = 65536;

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
  std::vector<MeshTriangle> triangles;
  for (std::int64_t first = 0; first < mesh.triangles(); first += block_triangles) {
    triangles.resize(static_cast<std::size_t>(std::min(block_triangles, mesh.triangles() - first)));
    mesh.read_triangles(first, triangles);
    for (const MeshTriangle& t : triangles) {
      const MeshVertex a = vertices[t[0]], b = vertices[t[1]], c = vertices[t[2]];
      const std::array<double, 3> area = area_vector(a, b, c, z_scale);
      for (const std::int64_t corner : t) add(normals[static_cast<std::size_t>(corner)], area);
    }
  }
  std::transform(normals.begin(), normals.end(), normals.begin(), unit);
  return normals;
}

}  // namespace arete
