#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace arete {

/// A place in a raster: columns and rows from the centre of its first cell.
using RasterPlace = std::array<double, 2>;
using RasterLine = std::vector<RasterPlace>;

/// What a TIN must follow, in the plane of the raster.
struct TinLines {
  std::vector<RasterLine> breaklines;  ///< each becomes edges of the mesh
  /// Closed rings (first place = last); the mesh covers what lies inside an odd number of them. Empty: no boundary.
  std::vector<RasterLine> boundary;

  bool empty() const { return breaklines.empty() && boundary.empty(); }
};

/// Units to a cell of meshes with lines.
inline constexpr int line_units = 1 << 16;

/// A straight piece of a line, in units from the centre of the tile's first cell.
struct LinePiece {
  std::array<std::int32_t, 2> from{}, to{};
  bool boundary = false;  ///< one side of it lies inside the boundary, the other outside
};

/// What a tile has to keep.
struct TileLines {
  std::vector<LinePiece> pieces;  ///< none lies along a side of the tile
  /// Where lines meet the sides: units along them, ascending.
  std::vector<std::int32_t> top, bottom, left, right;
};

/// Lines snapped to a grid of pixels and cut so that no two pieces meet but at their ends: iterated snap rounding (Halperin and Packer,
/// Computational Geometry 23, 2002). With d, half the side of a pixel (units):
///   1. no end of a piece lies within d of another piece of which it is no end;
///   2. no half-cell place (a cell's centre, a corner, the middle of a side) does: a line that passes one as closely passes through it;
///   3. ends lie on multiples of 2 d, which half-cell places are too;
///   4. each piece lies in one tile: where lines cross a border of tiles both tiles have the same place;
///   5. what lies outside the rectangle of the outermost cell centres is gone.
/// A line is moved by d or little more, in contrived cases by a few times that. The result depends on the lines, the tolerance and the tiles alone.
class LineArrangement {
 public:
  /// `columns`, `rows`: the first cells of the tiles along each side, and the last cell. `tolerance_cells`: at least so much is d; 2
  /// units at least, 1/32 cell at most. Throws Error{input} where the lines are so tangled that cutting does not end.
  LineArrangement(const TinLines& lines, std::span<const std::int64_t> columns, std::span<const std::int64_t> rows, double tolerance_cells);

  TileLines of_tile(std::size_t column, std::size_t row) const;

  struct Segment {
    std::array<std::int64_t, 2> from{}, to{};  ///< units from the centre of the raster's first cell; from < to
    bool breakline = false, boundary = false;
  };
  /// All pieces in order.
  const std::vector<Segment>& segments() const { return segments_; }

 private:
  std::vector<std::int64_t> columns_, rows_;
  std::vector<Segment> segments_;
  std::map<std::array<std::int64_t, 2>, std::vector<std::size_t>> of_tiles_;  // inside tiles
  std::map<std::int64_t, std::vector<std::int64_t>> on_columns_, on_rows_;    // ends on borders of tiles, along them
};

/// Whether a place lies inside an odd number of rings.
bool is_inside(std::span<const RasterLine> rings, const RasterPlace& place);

}  // namespace arete
