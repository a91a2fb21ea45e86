#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

/// Heights of a page: cell = low_m + steps * step_m.
struct PageHeights {
  static constexpr std::uint16_t void_step = 65535;
  static constexpr std::uint16_t max_step = 16385;

  Size size;
  double low_m = 0;                  ///< 0 where all cells are void
  double step_m = 0;                 ///< 1, 2 or 5 times a power of ten; 0 where all valid cells are equal
  std::vector<std::uint16_t> steps;  ///< row by row, at most max_step, void_step where void

  /// No valid cell is off by more.
  double error_m() const { return step_m / 2; }
};

/// Heights as multiples of the least round step that divides (highest - lowest) into at most 16384: no cell is off by more than half a
/// step, which is less than (highest - lowest) / 13107. Whole metres stay exact where the step is at most 1 m, for it divides them.
PageHeights quantise_heights(RasterView<const float> cells);

/// What a page holds of them: a zlib stream of 2 bytes a cell, first the lower bytes of all, then the upper. They make 0 where void, or 1 + 2r
/// for r >= 0 and -2r for r < 0, where r is the step less what west + north - northwest foretells, within [0, max_step]: in the first row
/// the cell to the west alone, in the first column the one to the north, 0 at first. A void cell counts as foretold for those after it.
std::vector<std::byte> pack_heights(const PageHeights& heights);

}  // namespace arete
