#pragma once

#include <cstdint>

#include "core/codec/predict_node.h"
#include "core/terrain/raster.h"

namespace arete {

/// A part of a level of the predictive coder, from (x, y) on.
struct LevelPart {
  Raster<std::int32_t> values;
  Raster<std::uint8_t> voids;  ///< 1 where void; empty where no cell of the raster is
  std::int64_t x = 0;
  std::int64_t y = 0;

  RasterView<const std::uint8_t> mask() const { return voids.size().cells() > 0 ? voids.view() : RasterView<const std::uint8_t>{}; }
  RasterView<const std::uint8_t> mask(const Window& w) const { return voids.size().cells() > 0 ? voids.view().sub(w) : mask(); }
  BlockView block() const { return {values.view(), mask()}; }
  LevelView view(const Size& level) const { return {values.view(), mask(), x, y, level}; }
};

}  // namespace arete
