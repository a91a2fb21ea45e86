#include "core/terrain/sea.h"

#include <algorithm>

namespace arete {

Raster<std::uint8_t> find_sea(RasterView<const float> cells) {
  const auto around = [&](std::int64_t x, std::int64_t y, const auto& visit) {
    for (std::int64_t j = std::max<std::int64_t>(0, y - 1); j <= std::min(cells.height - 1, y + 1); ++j)
      for (std::int64_t i = std::max<std::int64_t>(0, x - 1); i <= std::min(cells.width - 1, x + 1); ++i) visit(i, j);
  };
  Raster<std::uint8_t> sea(cells.width, cells.height, 0);
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) {
      const float z = cells(x, y);
      bool flat = z <= 0;
      if (flat) around(x, y, [&](std::int64_t i, std::int64_t j) { flat &= cells(i, j) == z; });
      if (flat) around(x, y, [&](std::int64_t i, std::int64_t j) { sea(i, j) = 1; });
    }
  return sea;
}

}  // namespace arete
