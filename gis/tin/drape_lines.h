#pragma once

#include <cstdint>
#include <span>

#include "core/terrain/raster_io.h"
#include "gis/tin/constraint_lines.h"
#include "gis/tin/tile_cells.h"

namespace arete {

/// Lines with as many vertices more, on their straight parts, as the terrain under them asks for: between vertices, and places where a part meets a
/// border of tiles or a void, the surface of the raster (bilinear between the centres of valid cells) is nowhere further than `error_m`
/// from the straight line in space, at places half a cell apart (Douglas and Peucker, 1973). `columns`, `rows`: the first cells of the tiles along each side, and
/// the last cell. Reads the tiles that lines pass, one at a time. No straight part over the raster is longer than
/// `longest_cells` (at least 4). What lies outside the raster stays as it is.
TinLines drape_lines(const RasterSource& raster, const TinLines& lines, std::span<const std::int64_t> columns, std::span<const std::int64_t> rows, double error_m,
                     double longest_cells = any_length);

/// The elevation between the centres of cells, of those that are valid; NaN where none is.
double height_between(RasterView<const float> cells, double column, double row);

}  // namespace arete
