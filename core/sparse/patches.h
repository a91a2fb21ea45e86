#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/sparse/patch_grid.h"
#include "core/terrain/raster.h"

namespace arete {

/// Which piece of a raster a patch is.
struct PatchOrigin {
  std::int64_t x = 0;         ///< first column and row; may lie outside the raster where edges repeat
  std::int64_t y = 0;
  std::uint8_t symmetry = 0;  ///< as AtomSource::symmetry
};

/// Pieces of terrain as vectors: m x m samples row-major, minus their plain mean, times the disc weights of the grid (so that
/// inner products are weighted by the disc, as in the authors' program).
struct Patches {
  Eigen::MatrixXf values;            ///< K x n, K = m^2
  std::vector<double> means;         ///< n, metres: the plain mean over the square
  std::vector<PatchOrigin> origins;  ///< n, row by row of the grid; the symmetries of a piece follow one another
  std::int64_t count() const { return values.cols(); }
};

enum class PatchEdges {
  inside,    ///< only patches that lie wholly in the raster, at multiples of the pitch from (0, 0)
  replicate  ///< every patch of the grid; beyond the border the edge cell repeats
};

struct PatchOptions {
  PatchEdges edges = PatchEdges::inside;
  bool symmetries = false;   ///< also the other 7 rotations and mirrors of each patch
  bool leave_out_flat = false;  ///< as is_flat_patch says: needed for dictionaries, where an atom has unit norm
  int threads = 0;
};

/// Every patch of the grid on `terrain` that has no void cell. Sums in double, in a fixed order.
Patches extract_patches(RasterView<const float> terrain, const PatchGrid& grid, const PatchOptions& options = {});

/// The patches at `origins`, in that order, but for those with a void cell and (on wish) flat ones. The grid gives m and the weights.
Patches cut_patches(RasterView<const float> terrain, const PatchGrid& grid, const std::vector<PatchOrigin>& origins, bool leave_out_flat,
                    int threads = 0);

/// Cuts the m x m cells at (x, y) under a symmetry, as they are (no mean, no weight), row-major; beyond the border the edge cell
/// repeats. False where a cell is void. `cells` has room for m x m values.
bool cut_cells(RasterView<const float> terrain, std::int64_t x, std::int64_t y, int patch_cells, std::uint8_t symmetry, float* cells);

/// Turns m x m cells into a patch in place: minus the plain mean, times the weights. Returns the mean.
double make_patch(const PatchGrid& grid, float* cells);

/// Whether a patch has no relief that its elevations could carry: norm <= 2^-20 |mean| sqrt(K), sixteen times the rounding of
/// float elevations at that height (2^-24 relative), and anything of norm below 1e-6 m. Such a direction is noise, not terrain.
bool is_flat_patch(double norm, double mean, std::int64_t samples);

/// Where sample (i, j) of a patch under a symmetry comes from in the m x m square that it was cut from: transposed first (bit 2), then
/// mirrored in x (bit 0) and y (bit 1).
struct CellIndex {
  int x = 0;
  int y = 0;
};
inline CellIndex source_cell(int i, int j, int cells, std::uint8_t symmetry) {
  if (symmetry & 1) i = cells - 1 - i;
  if (symmetry & 2) j = cells - 1 - j;
  return symmetry & 4 ? CellIndex{j, i} : CellIndex{i, j};
}

}  // namespace arete
