#pragma once

#include <cstdint>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// Where patches lie on a raster, and how they are weighted: geometry only.
///
/// A patch is m x m cells (m even), its centre on a corner of cells, with a disc of radius R = m/2 cells around it. Origins (first
/// cell of the square) lie at -(m - pitch) + k pitch in both directions: they begin before the raster and end beyond it, so that a
/// border cell has the same patches around it as any other.
struct PatchGrid {
  int patch_cells = 8;         ///< m
  int pitch = 4;               ///< cells between neighbouring patches
  std::vector<float> weights;  ///< m x m, row-major: falloff(distance of the sample's centre to the patch's centre / R)

  std::int64_t samples() const { return std::int64_t{patch_cells} * patch_cells; }
};

/// A grid of patches of `patch_cells` cells, `pitch` apart; pitch 0 means half a patch, which is R (Guérin et al. 2016).
/// Throws Error{usage} where patch_cells is odd or less than 2, pitch is outside [1, patch_cells], or the pitch leaves holes: a
/// cell whose weights sum to less than `least_cover`, under which blending would amplify rounding instead of terrain.
PatchGrid make_patch_grid(int patch_cells, int pitch = 0);
inline constexpr double least_cover = 1e-2;

/// The weights of a patch of `cells` x `cells` samples over the same disc, row-major: the window of a finer version of a patch.
std::vector<float> disc_weights(int cells);

/// The least sum of weights over the cells of the (periodic) grid. Not less than 0.5 at pitch R for even m, to float rounding: the
/// continuous minimum 4 g(1/sqrt 2) = 1/2 is where four discs are equally far.
double minimum_cover(const PatchGrid& grid);

/// How many patches lie along `cells` cells, and the first cell of patch k: the k of [0, patches_along) are those that touch
/// the raster. Patch (i, j) has its origin at column patch_origin(i), row patch_origin(j).
std::int64_t patches_along(const PatchGrid& grid, std::int64_t cells);
inline std::int64_t patch_origin(const PatchGrid& grid, std::int64_t k) {
  return k * grid.pitch - (grid.patch_cells - grid.pitch);
}

/// The first and one past the last k of the patches that touch the cells [begin, end), any integers.
struct PatchRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  std::int64_t count() const { return end - begin; }
};
PatchRange patches_touching(const PatchGrid& grid, std::int64_t begin, std::int64_t end);

}  // namespace arete
