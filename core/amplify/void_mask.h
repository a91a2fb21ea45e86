#pragma once

#include "core/terrain/raster.h"

namespace arete {

/// Makes the fine cells of void coarse cells void. `coarse` is the window itself, without margin.
inline void restore_voids(RasterView<const float> coarse, int factor, RasterView<float> fine) {
  for (std::int64_t y = 0; y < coarse.height; ++y)
    for (std::int64_t x = 0; x < coarse.width; ++x) {
      if (!is_void(coarse(x, y))) continue;
      for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i) fine(x * factor + i, y * factor + j) = void_value;
    }
}

}  // namespace arete
