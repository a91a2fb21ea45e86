#pragma once

#include <memory>
#include <span>

#include "core/terrain/georeference.h"

namespace arete {

/// A place in the lattice of a raster (column and row of cell centres, metres of the raster), or on the globe.
struct CellPlace {
  double column = 0, row = 0;  ///< 0, 0: the centre of the first cell
  double height_m = 0;
};
struct GlobePlace {
  double longitude = 0, latitude = 0;  ///< degrees on WGS 84; NaN: no such place
  double height_m = 0;                 ///< above the ellipsoid where GlobePlacement::ellipsoidal(), else as the raster says it
};

/// Where the cells of a raster lie on WGS 84 (EPSG:4326; EPSG:4979 with heights). Longitudes are within 180 degrees of that of the raster's
/// middle, so that they may pass 180. Heights become ellipsoidal where the CRS of the raster says what they refer to and PROJ has the
/// geoid of it; a height of 0 is asked for the shift where the height is NaN. May be used by several threads. Places do not
/// depend on what they are asked together with.
class GlobePlacement {
 public:
  /// Throws Error{input} where the raster has no transform or no CRS, or it cannot be related to WGS 84.
  GlobePlacement(const GeoReference& geo, Size size);
  ~GlobePlacement();
  bool ellipsoidal() const;
  void to_globe(std::span<const CellPlace> from, std::span<GlobePlace> to) const;
  /// Horizontally; heights stay as they are. NaN where a place has none in the raster's CRS.
  void to_cells(std::span<const GlobePlace> from, std::span<CellPlace> to) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
