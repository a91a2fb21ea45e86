#pragma once

#include <memory>
#include <string>

#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// A raster brought onto the grid of another by GDAL's warper, window by window.
/// Cubic convolution (Catmull-Rom), widened to an average where the new cells are larger than the old. CRS are transformed exactly
/// per cell; where both are the same, or one is unknown, only the transforms count. Void cells take no part; a cell whose centre lies
/// in a void cell or beyond the old raster is void. Heights are not changed: no vertical datum is shifted.
/// The values do not depend on the window they are read by. Reads are one at a time inside.
class WarpedSource final : public RasterSource {
 public:
  /// `source` must outlive it. Both need a transform. Throws Error{input} where the CRS cannot be related.
  WarpedSource(const RasterSource& source, const GeoReference& from, const GeoReference& to, Size size);
  ~WarpedSource() override;
  Size size() const override;
  void read(const Window& window, RasterView<float> out) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
