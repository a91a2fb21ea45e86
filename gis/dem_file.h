#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "core/terrain/value_type.h"

namespace arete {

/// Shrinks GDAL's block cache, which belongs to the process, to this; it is never grown.
void limit_block_cache(std::int64_t bytes);

struct DemReadOptions {
  int band = 1;              ///< counted from 1, as GDAL does
  bool terrain_rgb = false;  ///< three 8-bit bands of Mapbox terrain-RGB: -10000 + (R 65536 + G 256 + B) 0.1 m; `band` is ignored
  /// A raster whose smallest readable piece (block) is larger is refused: a header of a few bytes can ask for any amount.
  std::int64_t max_block_bytes = std::int64_t{1} << 30;
};

/// What a DEM file says of itself, for people.
struct DemDescription {
  std::string driver;     ///< GDAL's short name: GTiff
  std::string data_type;  ///< of the band, GDAL's name: Int16, Float32...
  int bands = 0;
  std::vector<std::string> band_names;  ///< one per band, empty where the file has none
  bool nodata_declared = false;
  bool masked = false;    ///< a mask or alpha band says which cells are valid
  double scale = 1;       ///< elevation = scale x stored + offset, in the vertical unit
  double offset = 0;
  std::string unit;       ///< of the band, as it is written there; empty where it names none (the CRS may know it)
  bool south_up = false;  ///< the file's rows run from south to north; here they are turned
  bool unit_stated = false;  ///< the file states a vertical unit; else metres are assumed
  bool unit_known = true;    ///< false: the file names a vertical unit that is not known, and it was taken as the metre
  std::map<std::string, std::string> metadata;  ///< of the dataset
  std::map<std::string, std::string> band_metadata;  ///< of the band, without its statistics
};

/// A DEM that GDAL opens, read by window: metres (scale, offset and vertical unit applied), NaN where void.
///
/// Void is: the declared nodata value (compared in the type of the file, and to 2e-6 of its size where it is beyond 1e30, because
/// such values are often declared rounded), a cell that a mask or alpha band leaves out, NaN and infinities whether declared
/// or not, and what does not fit in a float. Values are computed in double and rounded to float once.
///
/// The vertical unit is the band's; where the band names none, that of the vertical axis of the CRS; else the metre. A horizontal
/// CRS in feet says nothing of elevations. Row 0 is north: rows that run from south to north in the file are turned, and so
/// is the transform. A rotated or sheared transform is kept as it is.
class DemReader final : public RasterSource {
 public:
  /// Throws Error{input} where the file is missing, damaged or no raster, or has not that band; Error{format} where the band holds
  /// complex numbers; Error{memory} where a block exceeds max_block_bytes.
  explicit DemReader(const std::string& path, const DemReadOptions& options = {});
  ~DemReader() override;

  Size size() const override;
  /// Throws Error{input} where the file is damaged there. Reads are one at a time inside.
  void read(const Window& window, RasterView<float> out) const override;
  /// The numbers as the file stores them, without scale, offset or unit; NaN exactly where read() has a void. Each is a value of
  /// value_type(). Terrain-RGB gives its metres, rounded to float. Throws as read(), and Error{format} where an integer of 64
  /// bits is 2^53 or more.
  void read_stored(const Window& window, RasterView<double> out) const;
  /// The type of the stored numbers: the file's own; Float32 for terrain-RGB, Int16 for signed bytes. For integers of 64 bits the
  /// narrowest that holds the values and a void, Float64 at last: this reads the whole band, at every call. Throws as read_stored.
  ValueType value_type() const;

  const GeoReference& georeference() const;
  CellSize cell_size() const;  ///< at the centre
  const std::string& path() const;
  std::string data_type() const;  ///< GDAL's name: Int16, Float32...
  const DemDescription& description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct DemWriteOptions {
  std::string format = {};  ///< GDAL's short name; empty: by extension, COG for .tif and .tiff
  bool overwrite = false;
  std::vector<std::string> bands = {"elevation"};  ///< a name per band
  /// A unit per band, or empty: all bands are elevations. A band of unit "m" is converted to the file's vertical unit; any other
  /// (an index: "") is written as it is.
  std::vector<std::string> band_units = {};
  ValueType type = ValueType::float32;  ///< of every band
  double scale = 1;   ///< of the bands that are elevations: elevation in the vertical unit = scale x stored + offset. Not 0
  double offset = 0;
  /// What the bands that are elevations name as their unit; nullopt: the georeference's vertical unit. Empty: none.
  std::optional<std::string> unit = {};
  std::map<std::string, std::string> metadata = {};  ///< how it was made: ARETE_* items; TIFFTAG_SOFTWARE defaults to "arete <version>"
  std::map<std::string, std::string> band_metadata = {};  ///< of the first band
  std::int64_t memory_bytes = 256 << 20;  ///< GDAL's block cache, which belongs to the process, is shrunk to this, never grown
  int threads = 0;                        ///< of the compressor; 0: one per core. The bytes do not depend on it
};

/// Writes a DEM by window, in the vertical unit of its georeference, as numbers of the type, scale and offset of its options:
/// either metres (`write`; they are divided by metres_per_unit: a source in feet gives a file in feet), or the stored numbers
/// themselves (`write_stored`). What the type does not hold is held to it (hold_to: rounded, clamped), but metres that no float
/// holds, and infinities, are void.
///
/// Voids are written as the georeference's nodata value where the type holds it. Else floats become NaN, or -9999 in ASCII grids,
/// whose other readers know no NaN, and integers the lowest of their type; commit() throws Error{format} where a valid cell
/// has that value too. Where no stored number is void, the file declares exactly the nodata value of the georeference, or none
/// (an infinite one is never declared: GDAL 3.6 then takes every cell for void). A valid elevation that equals the
/// georeference's nodata value is moved to the next value of the type, so that it stays valid (stored numbers as DemReader
/// gives them never do). CRS (with its vertical part), registration, unit, scale, offset, band names and metadata are written as
/// far as the format holds them.
///
/// Guarantees: 1. nothing appears under the path, nor beside it, before commit() has written everything, checked it and flushed it
/// to the disk; then all files appear by rename, the main one last. 2. Without commit, or when it fails, an existing
/// output is as it was, and the folder holds nothing new. (Work in progress lies in a hidden folder `.arete-XXXXXX` beside the
/// output: the bytes of the type per cell and band, plus the output. Only a killed process leaves it.) 3. The same cells give the
/// same bytes for any order and size of windows, memory and threads.
class DemWriter final : public RasterSink {
 public:
  /// Throws Error{disk} where the output exists (and may not be overwritten) or its folder is missing or read-only,
  /// Error{format} where no driver writes that extension or the format holds no values of that type.
  DemWriter(const std::string& path, Size size, const GeoReference& geo, const DemWriteOptions& options = {});
  ~DemWriter() override;
  /// Cells that are never written are void. Throws Error{disk} where the disk is full or fails.
  void write(int band, const Window& window, RasterView<const float> cells) override;
  /// Writes the numbers of the first band as the file is to store them, NaN where void: DemReader::read_stored gives them back.
  void write_stored(const Window& window, RasterView<const double> cells);
  /// Makes the file in its format, with overviews for a COG, and gives it its name. Throws Error{disk}, or Error{format} where the
  /// driver refuses this raster or voids have no value; Error{interrupted} where `progress` says so.
  void commit(Progress* progress = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace arete
