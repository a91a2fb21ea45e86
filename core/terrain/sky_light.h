#pragma once

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"

namespace arete {

struct SkyLightOptions {
  double sun_azimuth_deg = 315;   ///< clockwise from north
  double sun_elevation_deg = 40;  ///< above the horizon
  double sun_width_deg = 4;       ///< the horizon hides the sun gradually over this angle: wider, softer shadows. > 0
  double exaggeration = 1;        ///< elevations are multiplied by this
  int directions = 16;            ///< of the sky's horizon, evenly spaced from north
  int threads = 0;                ///< 0: one per core; the same values for any number
};

/// What the terrain around lets through to each cell.
struct SkyLight {
  Raster<float> sky;  ///< share of the diffuse light of an even sky that reaches level ground there: 1 on a plain, towards 0 in a gorge
  Raster<float> sun;  ///< 1 in the sun, 0 in the shadow of other terrain, between at its edge. A slope's own angle is not in it.
};

/// Tangent of the elevation of the horizon as seen from every cell towards a compass direction: the steepest rise to any point on the
/// ray that far inside the raster, at least 0. Rays step one column (or row, whichever is faster) and interpolate between the
/// two cells beside them; their horizon is found on the convex hull of the profile (Timonen and Westerholm, "Scalable height
/// field self-shadowing", 2010), so that a direction costs one visit per cell. Elevations in metres without voids.
Raster<float> horizon(RasterView<const float> elevation, CellSize cell, double azimuth_deg, int threads = 0);

/// Sky and sun of every cell. sky = mean over the directions of cos^2 of the horizon's elevation, which is the view factor of the
/// sky for level ground. Cost: directions + 1 visits per cell. No voids: fill them first (fill_voids).
SkyLight measure_sky_light(RasterView<const float> elevation, CellSize cell, const SkyLightOptions& options = {});

}  // namespace arete
