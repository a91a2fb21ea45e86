#pragma once

#include <optional>

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"

namespace arete {

struct HillshadeOptions {
  double exaggeration = 1;             ///< elevations are multiplied by this
  double altitude_deg = 45;            ///< of the light above the horizon
  std::optional<double> azimuth_deg;   ///< one light from there, clockwise from north; nullopt: four lights, see below
};

/// Light that each cell of `part` reflects, 0 (dark) to 1 (facing the light), NaN where the cell is void.
/// Four lights from 225, 270, 315 and 360 degrees, weighted by sin^2(aspect - azimuth), so that ridges in every direction show:
/// Mark, "Multidirectional, oblique-weighted, shaded-relief image of the Island of Hawaii", USGS Open-File Report 92-422 (1992);
/// `gdaldem hillshade -multidirectional` (GDAL 3.6) takes cos^2 instead, which moves the light towards the west. The middle of the
/// lights is north-west, as on maps. Each light is the cosine between the normal and the direction of the light, at least 0. A
/// flat cell gets sin(altitude).
/// `part` lies inside `cells`; give one cell of halo where the terrain goes on. Voids and borders as horn_gradient; a cell
/// without any gradient counts as flat. `out` has the size of `part`. threads: 0, one per core.
void hillshade(RasterView<const float> cells, const Window& part, CellSize cell, const HillshadeOptions& options,
               RasterView<float> out, int threads = 0);

}  // namespace arete
