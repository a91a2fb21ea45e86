#include "gis/tin/void_sides.h"

#include <algorithm>

#include "gis/tin/tile_domain.h"

namespace arete {

VoidSide find_void_side(const TileMesh& mesh, std::int32_t triangle) {
  const std::int32_t units = mesh.units;
  VoidSide longest;
  for (std::int32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) {
    if (mesh.twin[h] >= 0) continue;
    const std::int32_t a = mesh.origin[h], b = mesh.origin[next_edge(h)];
    // Sides of the tile run through centres of cells, those along voids between them.
    const bool along_y = mesh.x[a] == mesh.x[b] && mesh.x[a] % units == units / 2, along_x = mesh.y[a] == mesh.y[b] && mesh.y[a] % units == units / 2;
    if (!along_x && !along_y) continue;
    const auto [low, high] = along_y ? std::minmax(mesh.y[a], mesh.y[b]) : std::minmax(mesh.x[a], mesh.x[b]);
    const std::int32_t cell = (low + high) / 2 / units, at = cell * units + units / 2;
    if (at <= low || at >= high || high - low <= longest.length) continue;
    longest = along_y ? VoidSide{h, high - low, mesh.x[a] / units, cell} : VoidSide{h, high - low, cell, mesh.y[a] / units};
  }
  return longest;
}

VoidSide find_void_side_about(const TileMesh& mesh, std::int32_t triangle) {
  std::vector<std::int32_t> about;
  for (std::int32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) append_star(mesh, h, about);
  VoidSide longest;
  for (const std::int32_t t : about)
    if (const VoidSide side = find_void_side(mesh, t); side.length > longest.length) longest = side;
  return longest;
}

void split_void_side(TileMesh& mesh, const TileCells& cells, const TileBound& bound, const VoidSide& side, std::vector<std::int32_t>& changed) {
  const std::int32_t half = mesh.units / 2;
  const double z = corner_height(cells, side.column, side.row, bound.height_step_m);
  const std::int32_t vertex = add_vertex(mesh, side.column * mesh.units + half, side.row * mesh.units + half, z, true);
  insert_vertex(mesh, side.edge / 3, vertex, changed);
}

}  // namespace arete
