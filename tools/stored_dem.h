#pragma once

#include "core/tree/measure.h"
#include "gis/dem_file.h"

namespace arete::tools {

/// A DEM's stored numbers as the tree coder reads them. The reader must outlive it.
class StoredDem final : public StoredSource {
 public:
  explicit StoredDem(const DemReader& dem) : dem_(dem) {}
  Size size() const override { return dem_.size(); }
  void read_stored(const Window& window, RasterView<double> out) const override { dem_.read_stored(window, out); }

 private:
  const DemReader& dem_;
};

}  // namespace arete::tools
