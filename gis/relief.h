#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/ground_style.h"
#include "core/terrain/overview.h"
#include "core/terrain/raster_io.h"
#include "gis/alignment.h"
#include "gis/image.h"

namespace arete {

/// A raster to be laid over the map of a DEM.
struct ReliefCover {
  std::string path;
  Placed dem;
};

struct ReliefOptions {
  std::string ramp = "land";             ///< one of ramp_names()
  std::int64_t width = 0;                ///< of the map in pixels at most; 0: the longest side has 2048 at most
  double exaggeration = 0;               ///< of heights for the light; 0: as much as makes the steepest tenth of gentle terrain
                                         ///< look like 30 degrees, 1 to 12 (1 for mountains)
  std::optional<double> azimuth_deg;     ///< one light from there; nullopt: four lights about the north-west
  GroundStyle style;                     ///< what the colours tell, contours; of draw_relief alone
  std::optional<ReliefCover> cover;      ///< its picture (read_drape) over the colours, lightly lit; of draw_relief alone
  bool legend = true;                    ///< colour bar, scale bar, signs; needs a font (find_font)
  bool metric = true;                    ///< whether the cell size is known; false leaves the scale bar out
  int threads = 0;                       ///< 0: one per core; the same picture for any number
};

/// A relief map with what it shows, for the user's eyes and for a report.
struct Relief {
  Picture picture;
  double low_m = 0, high_m = 0;     ///< range of the elevations; NaN where all is void
  double exaggeration = 1;          ///< that was used
  double metres_per_pixel = 0;
  double contour_interval_m = 0;    ///< 0: no contours
};

/// Draws hypsometric colours under a multidirectional hillshade (core/terrain/hillshade.h). Pixels are square on the ground. A large
/// raster is area-averaged as it is read (memory: the map, not the raster); a small one is magnified by a whole factor until
/// its longest side has up to 1024 pixels, every cell a sharp square. Void cells are hatched. Water - cells at or below 0 m
/// whose neighbours all have exactly the same height, and cells of that height beside them - is blue. The colours span the 0.1 to
/// 99.9 % percentiles of the land. In their place slopes (Horn's, of the cells that are drawn) or aspects may be coloured, contours drawn
/// and a raster laid over all. `cell`: metric size of a cell of the source.
Relief draw_relief(const RasterSource& source, CellSize cell, const ReliefOptions& options, Progress& progress);

/// One map of several that show the same ground.
struct ReliefPanel {
  std::string caption;
  const RasterSource* source = nullptr;
  CellSize cell;
};

/// Several maps side by side, row by row of `columns` (0: all in one row), captions above, one legend below. All have the same
/// size (options.width each, default 512), colour scale, light and exaggeration, those of the panels together; a coarser panel
/// shows its cells as squares. The panels should have the same extent. At least one panel.
Relief draw_relief_panels(const std::vector<ReliefPanel>& panels, int columns, const ReliefOptions& options, Progress& progress);

/// A relief to be laid over its ground in space, and that ground: a pixel per cell of the overview.
struct ReliefDrape {
  Picture picture;  ///< opaque; beside the rim of a void its colours go on, so that nothing foreign is mixed into the rim
  Overview ground;
};

struct Drapes {
  std::vector<ReliefDrape> drapes;
  double colour_low_m = 0, colour_high_m = 0;  ///< where the ramp begins and ends; NaN where all is void
  double exaggeration = 1;                     ///< for the light
  bool water = false;                          ///< whether there is any
};

/// The maps of draw_relief_panels, each alone and in the cells of its own raster, or in blocks of n x n of them: the least n with
/// which no side has more than `longest` pixels. At least one panel. options.width, legend and metric do not count.
Drapes drape_reliefs(const std::vector<ReliefPanel>& panels, std::int64_t longest, const ReliefOptions& options, Progress& progress);

/// Signed difference result - reference in diverging colours (blue: result too low, red: too high), symmetric about 0 up to
/// +-limit_m, over a faint hillshade of the reference; where cells are averaged to fit, the mean difference. Cells that are void
/// in either are hatched. Both of the same size. limit_m: usually the 99 % percentile of |difference|.
Relief draw_difference_map(const RasterSource& reference, const RasterSource& result, CellSize cell, double limit_m,
                           const ReliefOptions& options, Progress& progress);

}  // namespace arete
