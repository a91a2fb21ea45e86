#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/terrain/georeference.h"

namespace arete {

/// A raster as far as its place is concerned; `name` is what the user calls it.
struct Placed {
  std::string name;
  GeoReference geo;
  Size size;
};

/// The cells that two rasters share.
struct Alignment {
  Window reference, result;        ///< the common ground, in cells of each; of the same size
  std::vector<std::string> notes;  ///< for the user: what was assumed or left out
};

/// Two rasters on one lattice of cells: same CRS (horizontally), transforms that put every cell on a cell of the other to 1e-6 of
/// a cell. Different extents share their common window. A raster without CRS is taken to be in the CRS of the other; a
/// raster without transform to lie cell on cell, if it has the same size. Notes say so.
/// Throws Error{input} otherwise, one line that names both and points to --resample.
Alignment align_grids(const Placed& reference, const Placed& result);

/// Where the cells of another raster lie among those of a reference, at any size and turn: column = p[0] + x p[1] + y p[2], row = p[3] + x p[4] + y p[5], from the
/// outer corners of the first cells. Rasters without transform lie cell on cell, if they have the same size; one without CRS is taken to be in the other's.
/// Throws Error{input}, one line that names both, where their CRS differ or they share no ground.
std::array<double, 6> place_in_cells(const Placed& reference, const Placed& other);

/// True where both CRS (WKT) describe the same horizontal coordinates; names and vertical parts do not count. Not empty.
bool same_horizontal_crs(const std::string& a, const std::string& b);

}  // namespace arete
