#pragma once

#include <cstdint>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/overview.h"
#include "core/terrain/raster_io.h"

namespace arete {

/// What the renderer knows of a sample.
struct TerrainSample {
  float height = 0;  ///< metres, exactly the DEM's; where it is void a height from the valid ones around
  float smooth = 0;  ///< heights averaged with the weights of a tent as wide as the spacing: what slopes are taken from
  float valid = 1;   ///< 1 valid, 0 void; averaged likewise
  float water = 0;   ///< 1 where the DEM is exactly flat at or below 0 m; averaged likewise
};

/// A DEM at every power of two: sample i of level l is sample min(i 2^l, last) of the DEM, so that the last row and column are on all
/// levels. Levels whose samples fit in the budget are kept in memory; finer ones are made from windows of the source when asked.
///
/// A void sample has the mean height of its valid neighbours (of eight), else the height of the overview there, which must be
/// without voids: it depends on the sample alone, never on the window.
/// Water: find_sea (core/terrain/sea.h).
class SamplePyramid {
 public:
  /// The source and the overview must outlive the pyramid. Reads the source once, by windows.
  SamplePyramid(const RasterSource& source, const Overview& overview, std::int64_t memory_bytes, int threads, Progress& progress);

  /// Samples of level l along each side: ceil((size - 1) / 2^l) + 1.
  Size size(int level) const;
  /// Levels 0..levels()-1; the last has 17 x 17 samples at most.
  int levels() const { return static_cast<int>(kept_.size()); }
  /// Samples of a window of that level; outside the raster those of its border are repeated. Safe from several threads.
  void read(int level, const Window& window, RasterView<TerrainSample> out) const;

 private:
  void read_source(const Window& window, RasterView<TerrainSample> out) const;
  void make(int level, const Window& window, RasterView<TerrainSample> out) const;

  const RasterSource& source_;
  const Overview& overview_;
  std::vector<Raster<TerrainSample>> kept_;  // by level, empty where it is not kept
};

}  // namespace arete
