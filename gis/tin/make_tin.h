#pragma once

#include <cstdint>

#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "core/terrain/raster_io.h"
#include "gis/mesh/mesh_store.h"
#include "gis/tin/constraint_lines.h"
#include "gis/tin/tile_cells.h"

namespace arete {

struct TinOptions {
  double max_error_m = 1;             ///< above 0
  double height_step_m = 0;           ///< elevations of vertices are multiples of this power of two; 0: height_step(max_error_m)
  Displacement displacement;          ///< by which the mesh will be moved: the bound holds after that. Edges are kept so short that they sag by an eighth of it at most
  /// Passes of simplification after greedy insertion (simplify.h); 0: greedy insertion alone.
  int passes = 3;
  double extra_share = 0;  ///< so many triangles more, as a share of those that the bound needs, where errors are largest
  TinLines lines;  ///< whatever lies outside the raster has no effect
  int threads = 0;
  Scratch scratch;  ///< memory for all, and where a mesh beyond it goes
};

/// What was made, and proven of every valid cell of the raster.
struct TinReport {
  std::int64_t vertices = 0, triangles = 0;
  double bound_m = 0;               ///< that it was made within, after any displacement
  double max_error_m = 0;           ///< before any displacement: the largest distance of a cell from the mesh, vertically
  double rmse_m = 0;                ///< over the valid cells
  std::int64_t cells = 0;           ///< valid ones, inside the boundary
  std::int64_t full_triangles = 0;  ///< of the mesh that has every cell of the raster as a vertex
};

struct Tin {
  /// x: columns, y: rows, from the centre of the raster's first cell; z: metres. Triangles are counter-clockwise where rows run south.
  MeshStore mesh;
  TinReport report;
};

/// The largest step of elevations, a power of two, at most 2^-10 m, that leaves vertices free within a bound.
double height_step(double max_error_m);

/// Makes a TIN of a raster (metres, NaN void): no valid cell's centre is further from it than the bound, vertically; proven in exact
/// arithmetic for each cell. Vertices lie at the centres of cells, and along voids at their corners: the mesh covers the squares of
/// the valid cells exactly, cut at the centres of the raster's outer cells; and no more.
///
/// With lines, each breakline over valid cells is a chain of edges, at the elevation between the cells, with vertices enough to stay within half the
/// bound of it (drape_lines), and the mesh ends at the boundary. Places of lines are snapped to 1/65536 of a cell, and further where lines come close to each other or to half cells
/// (LineArrangement); the bound holds as before. All lines are held in memory, about 300 bytes a vertex.
///
/// Works by tiles of about 1024 x 1024 cells that share their borders, so that they join to one manifold. The tiles, and the mesh with
/// the order of its vertices, depend on the raster and the options alone, not on threads or memory. Holds at most about 240 MB a
/// thread for tiles, whatever the size of the raster.
/// Throws Error{input} where the raster has fewer than two rows or columns or no valid cell (inside the boundary) or lines are too
/// tangled, Error{usage} for a bound that is not above 0, Error{format} where it cannot be kept because of the displacement, with the
/// least that can, where that is known (not beside lines and voids), Error{interrupted}.
/// Source: greedy insertion after Garland and Heckbert (1995); simplification by half-edge collapse with elevations freed within
/// the bound.
Tin make_tin(const RasterSource& raster, const TinOptions& options, Progress& progress);

}  // namespace arete
