#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"

namespace arete {

struct DemReadOptions {
  int band = 1;              ///< counted from 1, as GDAL does
  bool terrain_rgb = false;  ///< three bands of Mapbox terrain-RGB: -10000 + (R 65536 + G 256 + B) 0.1 m
};

/// A DEM that GDAL opens, read by window: metres (scale, offset and vertical unit applied), NaN where nodata, masked, or NaN.
class DemReader final : public RasterSource {
 public:
  /// Throws Error{input} where the file is missing, damaged or no raster, or has not that band.
  explicit DemReader(const std::string& path, const DemReadOptions& options = {});
  ~DemReader() override;

  Size size() const override;
  /// Throws Error{input} where the file is damaged. Reads are one at a time inside.
  void read(const Window& window, RasterView<float> out) const override;

  const GeoReference& georeference() const;
  CellSize cell_size() const;      ///< at the centre
  const std::string& path() const;
  std::string data_type() const;   ///< GDAL's name: Int16, Float32...

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct DemWriteOptions {
  std::string format;       ///< GDAL's short name; empty: by extension, COG for .tif
  bool overwrite = false;
  std::vector<std::string> bands = {"elevation"};   ///< a name per band
  std::map<std::string, std::string> metadata;      ///< how it was made; ARETE_* items
  std::int64_t memory_bytes = 256 << 20;
};

/// Writes a DEM by window. Nothing appears under the path until commit() has written, checked and renamed it; without commit the
/// destructor removes what was begun. Elevations are written in metres as Float32 (bands beyond the first likewise).
class DemWriter final : public RasterSink {
 public:
  /// Throws Error{disk} where the output exists (and may not be overwritten) or its folder is missing or read-only,
  /// Error{format} where no driver writes that extension.
  DemWriter(const std::string& path, Size size, const GeoReference& geo, const DemWriteOptions& options = {});
  ~DemWriter() override;
  void write(int band, const Window& window, RasterView<const float> cells) override;
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
