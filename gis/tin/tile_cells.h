#pragma once

#include <cstdint>

#include "core/terrain/raster.h"

namespace arete {

/// The cells of a tile, metres, NaN where void. Its outer rows and columns are shared with the neighbours (or are the border of
/// the raster): what lies on them is settled by the border of the tile alone.
using TileCells = RasterView<const float>;

/// A limit of lengths that is none.
inline constexpr double any_length = 1e9;
/// The shortest limit, in cells: whatever the displacement, edges may be this long.
inline constexpr double least_length = 4;

/// What becomes of a triangle when its corners are placed in another plane and written: the bound must hold after it. All 0 where a
/// mesh stays in the plane of its raster and keeps its coordinates.
struct Displacement {
  double rounding_cells = 0;   ///< the file format moves a vertex by so much along x and y
  /// A straight line of L cells in the raster's plane lies up to bend_cells L² cells beside the straight edge that stands for it, and
  /// sag_m L² metres above or below it.
  double bend_cells = 0, sag_m = 0;
  double longest_cells = any_length;  ///< no edge may be longer than this; at least least_length
  bool any() const { return rounding_cells > 0 || bend_cells > 0 || sag_m > 0; }
};

/// The bound that a tile is meshed within, in numbers that proofs can compute with. Elevations of cells, elevations of vertices and
/// the bound are multiples of powers of two, few enough bits long that the plane of a triangle times its area, and its distance
/// from a cell, are exact in double: where an error equals the bound, no rounding decides.
struct TileBound {
  double error_m = 0;                 ///< no cell is further from the mesh than this, vertically
  double height_step_m = 1.0 / 1024;  ///< elevations of vertices are multiples of this power of two
  Displacement displacement;
  /// By so much does georeferencing move vertices that are not at half cells, along x and y.
  double noise_cells = 0;
};

/// The greatest bound not above `error_m` that has few enough bits.
double short_bound(double error_m);

/// Elevations are rounded to multiples of 2^-16 m before proofs: an error of at most half of that, none for whole metres and for
/// floats from 256 m on.
inline constexpr double cell_step_m = 1.0 / 65536;

}  // namespace arete
