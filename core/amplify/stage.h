#pragma once

#include "core/terrain/raster.h"

namespace arete {

/// What an amplification can give beside the elevation. A view without data is not wanted. All have factor x the window.
struct AmplifiedBands {
  RasterView<float> elevation;    ///< metres, NaN where the input is void
  RasterView<float> uncertainty;  ///< standard error expected of the elevation, metres
  RasterView<float> exemplar;     ///< which exemplar the strongest atom comes from, counted from 1; 0 for none
  RasterView<float> atom;         ///< index of the strongest atom, counted from 0; -1 for none
};

/// One step of amplification by a factor, ready to be evaluated on any window.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual int factor() const = 0;
  /// Coarse cells that `evaluate` needs around a window.
  virtual int margin() const = 0;
  /// Whether cells beyond the raster repeat its edge; otherwise they are void.
  virtual bool repeats_edge() const = 0;
  /// Amplifies `window` (in coarse cells of the whole raster); `coarse` is the window with its margin. A cell of the result depends
  /// on its own surroundings only, not on the window.
  virtual void evaluate(const Window& window, RasterView<const float> coarse, const AmplifiedBands& out, int threads) const = 0;
};

}  // namespace arete
