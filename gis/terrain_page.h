#pragma once

#include <array>
#include <string>
#include <vector>

#include "gis/image.h"
#include "gis/page_heights.h"

namespace arete {

/// Terrain as a page shows it.
struct PageTerrain {
  std::string name;                ///< above the terrain, and beside the divider
  std::vector<std::string> facts;  ///< lines of text below the name
  PageHeights heights;             ///< a vertex per valid cell, at its centre
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
  std::string credit;                 ///< whose data it shows, below the scale; empty: nobody is named
};

/// One HTML file that needs no other file and no network: heights as pack_heights makes them, pictures as JPEG, and three.js with its
/// licence. It opens from a disk, or within a frame, and needs a browser with WebGL 2 and DecompressionStream (Chromium 80, Firefox 113, Safari
/// 16.4 or later); it says so where one is missing. About 0.3 MB, a byte a cell, and the pictures. The same page, the same bytes.
/// All texts are plain text, in UTF-8. Throws Error{disk} as StagedFiles.
void write_terrain_page(const std::string& path, const TerrainPage& page, bool overwrite = false);

}  // namespace arete
