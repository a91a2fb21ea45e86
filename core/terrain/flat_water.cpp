#include "core/terrain/flat_water.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace arete {
namespace {

struct CellPlace {
  std::int64_t x, y;
};

/// One step of every shore cell into its equal neighbours.
void grow(RasterView<const float> cells, std::vector<CellPlace>& shore, Raster<std::uint8_t>& water) {
  std::vector<CellPlace> next;
  for (const CellPlace& from : shore)
    for (const CellPlace& step : {CellPlace{-1, 0}, CellPlace{1, 0}, CellPlace{0, -1}, CellPlace{0, 1}}) {
      const std::int64_t x = from.x + step.x, y = from.y + step.y;
      if (x < 0 || y < 0 || x >= cells.width || y >= cells.height || water(x, y) || cells(x, y) != cells(from.x, from.y)) continue;
      water(x, y) = 1;
      next.push_back({x, y});
    }
  shore = std::move(next);
}

}  // namespace

Raster<std::uint8_t> find_flat_water(RasterView<const float> cells) {
  const std::int64_t w = cells.width, h = cells.height;
  constexpr int side = flat_water_side;
  Raster<std::uint8_t> water(w, h, 0);
  if (w < side || h < side) return water;
  // run(x, y): how many cells leftwards from (x, y) are equal to it, itself included.
  Raster<std::uint8_t> run(w, h);
  for (std::int64_t y = 0; y < h; ++y)
    for (std::int64_t x = 0; x < w; ++x)
      run(x, y) = x > 0 && cells(x, y) == cells(x - 1, y) ? static_cast<std::uint8_t>(std::min(side, run(x - 1, y) + 1)) : 1;
  for (std::int64_t y = side - 1; y < h; ++y)
    for (std::int64_t x = side - 1; x < w; ++x) {
      const float z = cells(x, y);
      bool level = run(x, y) == side;
      for (int j = 1; level && j < side; ++j) level = run(x, y - j) == side && cells(x, y - j) == z;
      if (!level) continue;
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) water(x - i, y - j) = 1;
    }
  std::vector<CellPlace> shore;
  for (std::int64_t y = 0; y < h; ++y)
    for (std::int64_t x = 0; x < w; ++x)
      if (water(x, y)) shore.push_back({x, y});
  for (int step = 0; step < flat_water_growth && !shore.empty(); ++step) grow(cells, shore, water);
  return water;
}

}  // namespace arete
