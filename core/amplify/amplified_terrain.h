#pragma once

#include <memory>

#include "core/amplify/stage.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// A terrain made finer by a stage, evaluated on demand: stages chain by taking one another as their source, and nothing but the
/// window at hand is ever in memory. Reads are the same for any window and any number of threads.
class AmplifiedTerrain final : public RasterSource {
 public:
  /// Neither the source nor the stage is owned: both must outlive the terrain.
  AmplifiedTerrain(const RasterSource& coarse, const Stage& stage, int threads) : coarse_(coarse), stage_(stage), threads_(threads) {}

  Size size() const override;
  void read(const Window& window, RasterView<float> out) const override;
  /// The wanted bands of a window. Where the source is itself amplified its uncertainty is added in quadrature.
  void read_bands(const Window& window, const AmplifiedBands& bands) const;

 private:
  Raster<float> read_coarse(const Window& window) const;

  const RasterSource& coarse_;
  const Stage& stage_;
  int threads_;
};

}  // namespace arete
