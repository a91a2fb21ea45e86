#pragma once

#include <optional>

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"

namespace arete {

/// First derivatives of the surface, metres per metre: `east` grows to the right (columns), `north` towards row 0.
struct Gradient {
  double east = 0;
  double north = 0;
};

/// Slope angle in degrees, 0 (flat) to 90.
double slope_deg(const Gradient& gradient);

/// Compass direction that the surface faces (downhill), degrees clockwise from north in [0, 360). A flat cell gives 0.
double aspect_deg(const Gradient& gradient);

/// Gradient at cell (x, y) by the 3x3 operator of Horn (Hill shading and the reflectance map, Proc. IEEE 69(1), 1981), the one
/// that gdaldem uses: the mean of three central differences with weights 1, 2, 1. Exact on a plane.
/// A neighbour outside the view, or void, is left out: its row (or column) takes the one-sided difference, or drops out of the
/// mean when it has none, so that a plane is exact to the border and no void leaks. Nullopt where the cell itself is void, or
/// no difference is left in one direction.
std::optional<Gradient> horn_gradient(RasterView<const float> cells, std::int64_t x, std::int64_t y, CellSize cell);

/// As horn_gradient, but nullopt wherever one of the nine cells is missing: for metrics, where each cell must mean the same.
std::optional<Gradient> complete_gradient(RasterView<const float> cells, std::int64_t x, std::int64_t y, CellSize cell);

/// By how much, as a round number from 1 to `most`, heights are exaggerated so that a slope (metres per metre) looks like so many degrees at most; 1 for
/// steeper ones.
double exaggeration_for(double slope, double looks_like_deg, double most);

/// Slope in degrees of every cell of `part`, which lies inside `cells`; give one cell of halo around it where the terrain goes on.
/// `out` has the size of `part`; NaN where horn_gradient has no value. threads: 0, one per core.
void slope(RasterView<const float> cells, const Window& part, CellSize cell, RasterView<float> out, int threads = 0);

}  // namespace arete
