// É. Guérin, J. Digne, É. Galin, A. Peytavie, "Sparse representation of terrains for procedural modeling", Eurographics 2016:
// half-overlapping discs, blended by their falloff.
#include "core/sparse/patch_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/sparse/falloff.h"
#include "core/support/error.h"

namespace arete {

namespace {

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

std::vector<float> disc_weights(int cells) {
  const double radius = cells / 2.0;
  std::vector<float> weights;
  weights.reserve(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x)
      weights.push_back(static_cast<float>(falloff(std::hypot(x + 0.5 - radius, y + 0.5 - radius) / radius)));
  return weights;
}

PatchGrid make_patch_grid(int patch_cells, int pitch) {
  if (patch_cells < 2 || patch_cells % 2 != 0)
    throw Error(ErrorKind::usage, "patch of " + std::to_string(patch_cells) + " cells: expected an even number, at least 2");
  if (pitch == 0) pitch = patch_cells / 2;
  if (pitch < 1 || pitch > patch_cells)
    throw Error(ErrorKind::usage, "patch pitch of " + std::to_string(pitch) + " cells: expected 1 to " +
                                      std::to_string(patch_cells) + ", the size of a patch");
  PatchGrid grid{patch_cells, pitch, disc_weights(patch_cells)};
  if (minimum_cover(grid) < least_cover)
    throw Error(ErrorKind::usage, "patch pitch of " + std::to_string(pitch) + " cells leaves holes between discs of " +
                                      std::to_string(patch_cells) + " cells: give a smaller pitch, such as " +
                                      std::to_string(patch_cells / 2));
  return grid;
}

double minimum_cover(const PatchGrid& grid) {
  const int m = grid.patch_cells;
  double least = static_cast<double>(m) * m;
  for (int y = 0; y < grid.pitch; ++y)
    for (int x = 0; x < grid.pitch; ++x) {
      double sum = 0;
      for (int j = y; j < m; j += grid.pitch)
        for (int i = x; i < m; i += grid.pitch) sum += grid.weights[static_cast<std::size_t>(j * m + i)];
      least = std::min(least, sum);
    }
  return least;
}

std::int64_t patches_along(const PatchGrid& grid, std::int64_t cells) { return patches_touching(grid, 0, cells).end; }

PatchRange patches_touching(const PatchGrid& grid, std::int64_t begin, std::int64_t end) {
  if (end <= begin) return {};
  // Patch k covers [k p - (m - p), k p + p): it touches where k p + p > begin and k p - (m - p) < end.
  const std::int64_t p = grid.pitch;
  return {floor_div(begin, p), floor_div(end - 1 + grid.patch_cells - p, p) + 1};
}

}  // namespace arete
