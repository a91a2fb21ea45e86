#pragma once

#include <cstdint>
#include <string>

#include "gis/alignment.h"
#include "gis/image.h"

namespace arete {

/// A picture to be laid over a DEM.
struct DrapePicture {
  Picture picture;  ///< rows and columns run along those of the DEM; opacity 0 where there is nothing to lay over the ground
  double left = 0, top = 0, width = 0,
         height = 0;    ///< what it covers, in cells of the DEM from the outer corner of the first; inside the DEM
  bool opaque = false;  ///< it covers all of the DEM, and no pixel lets the ground through
  bool values = false;  ///< of one band of numbers, in the colours of viridis from low to high
  double low = 0, high = 0;
};

struct DrapeLimits {
  std::int64_t longest = 8192;  ///< pixels of the longer side at most
  double per_cell = 1e9;        ///< pixels along a side of a cell of the DEM at most
};

/// Reads any raster of GDAL's as a picture on the grid of a DEM, of about its own resolution within the limits: warped from its
/// CRS by GDAL (bilinear, averaged where pixels become larger), strip by strip. Three bands and more: red, green and blue, by
/// name or in that order; a palette: its colours; one band or two: bytes are grey, other numbers go through viridis. Numbers that
/// are no bytes are stretched from their 1 to their 99 % percentile. Nodata, masks and an alpha band make pixels transparent. A
/// raster or DEM without CRS is taken to be in the CRS of the other; without georeference the raster is taken to show all of the
/// DEM, if its proportions are the DEM's to 1 %. Throws Error{input}, one line that names both, where it cannot be read or
/// related to the DEM, or where they share no ground.
DrapePicture read_drape(const std::string& path, const Placed& dem, const DrapeLimits& limits = {});

}  // namespace arete
