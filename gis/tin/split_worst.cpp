#include "gis/tin/split_worst.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gis/tin/heights.h"
#include "gis/tin/triangle_errors.h"

namespace arete {
namespace {

constexpr double least_height = 1.0 / 16;  // of triangles in meshes with lines, cells

struct Worst {
  double error = 0;
  std::int32_t triangle = 0, column = 0, row = 0;
};

Worst worst_of(const TileMesh& mesh, const TileCells& cells, std::int32_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  const TrianglePlane plane = plane_of(mesh, a, b, c);
  Worst worst{0, triangle, 0, 0};
  for_each_difference(mesh, cells, a, b, c, plane, [&](double difference, std::int32_t row, std::int32_t column) {
    if (std::abs(difference) > worst.error) worst = {std::abs(difference), triangle, column, row};
  });
  worst.error /= plane.area2;
  return worst;
}

}  // namespace

void split_worst(TileMesh& mesh, const TileCells& cells, const TileBound& bound, std::int64_t splits) {
  std::vector<Worst> order;
  for (std::int32_t t = 0; t < mesh.triangles(); ++t)
    if (!mesh.removed(t)) order.push_back(worst_of(mesh, cells, t));
  std::sort(order.begin(), order.end(), [](const Worst& a, const Worst& b) { return a.error != b.error ? a.error > b.error : a.triangle < b.triangle; });
  for (const Worst& worst : order) {
    if (splits == 0 || worst.error == 0) return;
    const auto [a, b, c] = mesh.corners(worst.triangle);
    const std::int32_t v = add_vertex(mesh, worst.column * mesh.units, worst.row * mesh.units,
                                      round_height(cells(worst.column, worst.row), bound.height_step_m), false);
    double squares = 0;
    const auto good = [&](std::int32_t from, std::int32_t to) {
      const std::int64_t area2 = orientation(mesh, from, to, v);
      if (area2 <= 0) return false;
      // Finer units than half cells do not keep triangles from being thin.
      if (mesh.units != 2 && static_cast<double>(area2) < least_height * mesh.units * std::sqrt(longest_squared(mesh, from, to, v))) return false;
      const TriangleFit fit = fit_of(mesh, cells, from, to, v, bound);
      squares += fit.squares;
      return fit.keeps;
    };
    if (good(a, b) && good(b, c) && good(c, a) && squares < fit_of(mesh, cells, a, b, c, bound).squares) {
      split_triangle(mesh, worst.triangle, v);
      --splits;
    } else {
      drop_last_vertex(mesh);
    }
  }
}

}  // namespace arete
