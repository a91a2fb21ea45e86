#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/terrain/raster.h"
#include "gis/image.h"

namespace arete {

/// Terrain as a page shows it.
struct PageTerrain {
  std::string name;                ///< above the terrain, and beside the divider
  std::vector<std::string> facts;  ///< lines of text below the name
  Raster<float> cells;             ///< metres, NaN where void; a vertex per valid cell, at its centre
  /// Where the outer corner of cell (column, row) lies, in metres: east = p[0] + column p[1] + row p[2], south = p[3] + column p[4] + row p[5].
  std::array<double, 6> placement = {0, 1, 0, 0, 0, 1};
  Picture picture;                 ///< opaque
  double pixels_per_cell = 1;      ///< of the picture, whose upper left corner is that of cell (0, 0)
};

/// A page for a browser on which one terrain, or two at one place, can be turned about.
struct TerrainPage {
  std::string title;
  std::vector<PageTerrain> terrains;  ///< one, or two: left and right of a divider that the user moves
  std::vector<Colour> ramp;           ///< of the legend, from low to high; empty: no legend
  double low_m = 0, high_m = 0;       ///< the ends of the ramp
  double exaggeration = 1;            ///< of the heights, until the user changes it
  bool metric = true;                 ///< whether metres are known to be metres; false leaves the scale bar out
};

/// Heights of a page are whole steps above the lowest.
struct PageHeights {
  double low_m = 0;                  ///< 0 where all cells are void
  double step_m = 0;                 ///< (highest - lowest) / 65534
  std::vector<std::uint16_t> steps;  ///< row by row, 65535 where void
};

/// No valid cell is off by more than half a step.
PageHeights quantise_heights(RasterView<const float> cells);

/// One HTML file that needs no other file and no network: heights in 16 bits, pictures as JPEG, three.js with its licence. It needs a
/// browser with WebGL 2 and says so where there is none. About 1.2 MB, 2.7 bytes a cell, and the pictures. The same page, the same bytes.
/// All texts are plain text, in UTF-8. Throws Error{disk} as StagedFiles.
void write_terrain_page(const std::string& path, const TerrainPage& page, bool overwrite = false);

}  // namespace arete
