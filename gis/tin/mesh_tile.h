#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gis/tin/tile_cells.h"
#include "gis/tin/tile_domain.h"
#include "gis/tin/tile_mesh.h"

namespace arete {

/// Four cells of a tile, by the one with the least column and row.
struct CellSquare {
  std::int32_t column = 0, row = 0;
};

/// How the four sides of a tile are meshed, where otherwise than its inside.
struct SideOptions {
  double error_m = 0;                 ///< the bound; 0: that of the inside
  double longest_cells = any_length;  ///< no edge may be longer; displacement.longest_cells holds too
};

struct TileOptions {
  double max_error_m = 1;
  double height_step_m = 1.0 / 1024;  ///< a power of two
  Displacement displacement;
  int passes = 3;                     ///< of simplify(); 0: greedy insertion alone
  double extra_share = 0;             ///< of the triangles at the end, which are spent again on the worst ones (split_worst)
  SideOptions sides;
  /// Squares whose corners are to be vertices, at the elevations of their cells, and whose sides are to be edges; but corners that are void
  /// or on a side of the tile.
  std::span<const CellSquare> squares = {};
};

/// What the cells of a tile lie off its mesh. The outer rows and columns are shared: each tile counts its top row and left
/// column, and its right column and bottom row where it is the last of its row or column.
struct TileErrors {
  double max_error_m = 0;
  double squares = 0;               ///< sum over the cells, m²
  std::int64_t cells = 0;           ///< valid ones
  std::int64_t full_triangles = 0;  ///< two for each four valid cells about a corner, one for three: the mesh without any simplification
};

/// A cell on a side of a tile, and how far it lies off the mesh.
struct SideCell {
  std::int32_t column = 0, row = 0;
  double error_m = 0;
};

struct MeshedTile {
  TileMesh mesh;  ///< sorted (sort_mesh); no triangles where no cell is valid
  TileErrors errors;
  /// With a boundary: the cells on all four sides that triangles touch, those at corners twice. They are not in the errors: the tile beyond may have
  /// them too, or alone.
  std::vector<SideCell> side_cells;
};

/// Meshes a tile within the bound: its four sides first, each from its own cells, then greedy insertion, then simplification; and
/// measures every cell. `last_column`, `last_row`: no tile follows to the right, below. Throws as insert_greedily.
/// With lines they are edges of the mesh, whose units are line_units; the bound is kept with a reserve for what georeferencing moves
/// vertices. Throws Error{input}, or Error{format} where the format rounds, where lines leave triangles too thin for that.
MeshedTile mesh_tile(RasterView<const float> cells, const TileOptions& options, bool last_column, bool last_row, const DomainLines* lines = nullptr);

}  // namespace arete
