#pragma once

#include <cstdint>
#include <vector>

#include "core/amplify/activity.h"
#include "core/sparse/omp.h"
#include "core/sparse/patch_grid.h"
#include "core/terrain/raster.h"

namespace arete {

/// The patches of a grid that touch a window, as sparse codes over a dictionary.
struct CodedPatches {
  PatchRange columns, rows;     ///< of the grid
  SparseCodes codes;            ///< patch (i, j) is column (j - rows.begin) columns.count() + i - columns.begin
  std::vector<double> means;    ///< plain mean of each patch, metres
  std::vector<float> activity;  ///< of each patch; empty unless a meter was given
  std::vector<char> known;      ///< 0: has a void cell, its code is empty
  std::int64_t index(std::int64_t column, std::int64_t row) const {
    return (row - rows.begin) * columns.count() + column - columns.begin;
  }
};

/// Codes every patch that touches `window`. `terrain` has its cell (0, 0) at the coordinates (origin_x, origin_y) of the grid, and
/// a margin of patch_cells - 1 around the window. A patch's code depends on its own cells only.
CodedPatches code_patches(RasterView<const float> terrain, std::int64_t origin_x, std::int64_t origin_y, const Window& window,
                          const PatchGrid& grid, const CodingDictionary& dictionary, int sparsity, const ActivityMeter* meter,
                          int threads);

}  // namespace arete
