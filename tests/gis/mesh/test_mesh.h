#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"
#include "gis/mesh/mesh_store.h"

namespace arete {

/// A mesh that tests can damage.
struct TestMesh {
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;

  MeshStore store() const {
    MeshStore mesh;
    mesh.append_vertices(vertices);
    mesh.append_triangles(triangles);
    return mesh;
  }
  /// The first vertex at this place.
  std::int64_t at(double x, double y) const {
    const auto found = std::find_if(vertices.begin(), vertices.end(), [&](const MeshVertex& v) { return v.x == x && v.y == y; });
    return found == vertices.end() ? -1 : found - vertices.begin();
  }
};

/// The place of a centre of cells (fractions too) in the plane of a raster.
inline MeshVertex place(const GeoReference& geo, double column, double row, double z) {
  const auto t = geo.transform.value_or(std::array<double, 6>{0, 1, 0, 0, 0, -1});
  return {t[0] + (column + 0.5) * t[1] + (row + 0.5) * t[2], t[3] + (column + 0.5) * t[4] + (row + 0.5) * t[5], z};
}

/// Every step-th cell of a raster without voids, and its last column and row, joined by two triangles for each square.
inline TestMesh grid_mesh(RasterView<const float> dem, std::int64_t step, const GeoReference& geo = {}) {
  const auto stops = [step](std::int64_t length) {
    std::vector<std::int64_t> at;
    for (std::int64_t i = 0; i < length - 1; i += step) at.push_back(i);
    at.push_back(length - 1);
    return at;
  };
  const std::vector<std::int64_t> columns = stops(dem.width), rows = stops(dem.height);
  const auto across = static_cast<std::int64_t>(columns.size());
  TestMesh mesh;
  for (const std::int64_t row : rows)
    for (const std::int64_t column : columns)
      mesh.vertices.push_back(place(geo, static_cast<double>(column), static_cast<double>(row), static_cast<double>(dem(column, row)) / geo.metres_per_unit));
  for (std::int64_t j = 0; j + 1 < static_cast<std::int64_t>(rows.size()); ++j)
    for (std::int64_t i = 0; i + 1 < across; ++i) {
      const std::int64_t a = j * across + i, b = a + 1, c = a + across, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  return mesh;
}

/// Exactly the domain of a raster: each quarter of a valid cell two triangles, its centre at its elevation, its corners and the middles of
/// its sides at the mean of the valid cells around.
inline TestMesh quarter_mesh(RasterView<const float> dem, const GeoReference& geo = {}) {
  TestMesh mesh;
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> known;  // by place in half cells
  const auto vertex = [&](std::int64_t x, std::int64_t y) {
    const auto [found, fresh] = known.try_emplace({x, y}, static_cast<std::int64_t>(mesh.vertices.size()));
    if (!fresh) return found->second;
    double sum = 0, count = 0;
    for (std::int64_t row = y / 2; row <= (y + 1) / 2; ++row)
      for (std::int64_t column = x / 2; column <= (x + 1) / 2; ++column)
        if (!is_void(dem(column, row))) sum += static_cast<double>(dem(column, row)), ++count;
    mesh.vertices.push_back(place(geo, static_cast<double>(x) / 2, static_cast<double>(y) / 2, sum / count / geo.metres_per_unit));
    return found->second;
  };
  for (std::int64_t y = 0; y < 2 * (dem.height - 1); ++y)
    for (std::int64_t x = 0; x < 2 * (dem.width - 1); ++x) {
      if (is_void(dem((x + 1) / 2, (y + 1) / 2))) continue;  // the cell that this quarter belongs to
      const std::int64_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x, y + 1), d = vertex(x + 1, y + 1);
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  return mesh;
}

}  // namespace arete
