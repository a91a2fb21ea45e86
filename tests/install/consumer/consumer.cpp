// Averages a ramp by blocks of 2, and asks for the size of a cell.
#include <cstdio>

#include "core/terrain/georeference.h"
#include "core/terrain/resample.h"
#include "gis/geodesy.h"

int main() {
  arete::Raster<float> fine(4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) fine(x, y) = static_cast<float>(x + 10 * y);
  const arete::Raster<float> coarse = arete::area_average(fine.view(), 2);

  arete::GeoReference geo;
  geo.transform = {0, 30, 0, 0, 0, -20};
  const arete::CellSize cell = arete::cell_size(geo, {4, 4});
  std::printf("%g %g, cell %g x %g\n", static_cast<double>(coarse(0, 0)), static_cast<double>(coarse(1, 1)), cell.x_m, cell.y_m);
}
