#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "gis/colour_ramp.h"
#include "gis/image.h"

namespace arete {

/// A straight line over a raster, its ends (x, y) in the raster's CRS; columns and rows from the upper left corner, rows downwards, where it has no transform.
struct MapLine {
  std::array<double, 2> from{}, to{};
};

/// From the middle of the left side of a raster to that of its right side.
MapLine middle_line(const GeoReference& geo, Size size);

struct ProfilePoint {
  double distance_m = 0;   ///< on the ground, from the line's start
  double elevation_m = 0;  ///< NaN where void, and outside the raster
};

/// What lies under a line, from its start to its end, at least twice per cell: elevations of the smooth surface through the cells (core/terrain/surface.h),
/// distances as distances_along (geodesy.h). At most 20,000 points: a longer line is sampled more coarsely.
/// Throws Error{usage} where the line has no length or is not finite.
std::vector<ProfilePoint> sample_profile(const RasterSource& source, const GeoReference& geo, const MapLine& line);

struct ProfileDrawing {
  std::string title;                     ///< over the drawing; empty: none
  std::int64_t width = 1600, height = 640;
  double exaggeration = 0;               ///< of heights over distances; 0: as much as fills the drawing, a round number
};

/// A drawing with the exaggeration that it has.
struct DrawnProfile {
  Picture picture;
  double exaggeration = 1;
};

/// The ground in the colours of its elevations under a dark line, distances along the bottom and elevations at the left; void stretches are hatched.
/// Words need a font (find_font). Throws Error{input} where no point has an elevation, Error{usage} where so large an exaggeration does not fit.
DrawnProfile draw_profile(const std::vector<ProfilePoint>& points, const ColourRamp& ramp, const ProfileDrawing& options);

}  // namespace arete
