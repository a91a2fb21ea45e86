#include "gis/mesh/gltf_grid.h"

#include <algorithm>
#include <cmath>

namespace arete {
namespace {

constexpr double offset_multiple = 16;
constexpr double greatest_reach = 8192;
constexpr double greatest_reach_draco = 4096;
constexpr double least_reach = 1;
constexpr double least_reach_draco = 16;
constexpr double steps_of_reach = 1 << 24;
constexpr double steps_of_reach_draco = 1 << 22;

}  // namespace

GltfGrid gltf_grid(const MeshBounds& bounds, bool draco) {
  const std::array<double, 3> low{bounds.low.x, bounds.low.y, bounds.low.z}, high{bounds.high.x, bounds.high.y, bounds.high.z};
  const double limit = draco ? greatest_reach_draco : greatest_reach;
  const double steps = draco ? steps_of_reach_draco : steps_of_reach;
  GltfGrid grid;
  for (std::size_t a = 0; a < 3; ++a) {
    GltfAxis& axis = grid.axes[a];
    axis.reach = draco ? least_reach_draco : least_reach;
    axis.offset = std::round((low[a] / 2 + high[a] / 2) / offset_multiple) * offset_multiple;
    // Rounding may move the outermost vertex by half a step.
    const double extent = std::max(high[a] - axis.offset, axis.offset - low[a]);
    while (axis.reach < limit && extent > axis.reach - axis.reach / steps) axis.reach *= 2;
    axis.in_cells = extent > axis.reach - axis.reach / steps;
  }
  if (draco) {
    const double reach = std::max({grid.axes[0].reach, grid.axes[1].reach, grid.axes[2].reach});
    for (GltfAxis& axis : grid.axes) axis.reach = reach;
  }
  for (GltfAxis& axis : grid.axes) axis.step = axis.reach / steps;
  return grid;
}

}  // namespace arete
