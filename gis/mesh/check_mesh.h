#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "gis/mesh/mesh.h"
#include "gis/mesh/seams.h"
#include "gis/mesh/topology.h"

namespace arete {

struct MeshCheckOptions {
  std::optional<double> max_error_m;  ///< the bound, >= 0; nullopt: errors are measured, none is too large
  bool allow_uncovered = false;       ///< the mesh was clipped: valid cells without triangle are no fault
  double snap_cells = 1e-6;           ///< RasterPlane's; larger for formats that move vertices further
  Scratch scratch;
};

/// How many cells, and the first of them in the order of rows; -1: none.
struct CellFault {
  std::int64_t count = 0;
  std::int64_t column = -1, row = -1;
};

/// A mesh against the DEM that it was made of.
struct MeshErrors {
  std::int64_t vertices = 0, triangles = 0;
  std::int64_t cells = 0, valid_cells = 0;
  std::int64_t compared_cells = 0;   ///< valid, their centre in or on a triangle
  double low_m = 0, high_m = 0;      ///< of the valid cells; NaN where there is none
  /// Over the compared cells: |height of the mesh at the centre - elevation|. NaN and -1 where none was compared.
  double max_error_m = 0;
  std::int64_t max_column = -1, max_row = -1;
  double max_x = 0, max_y = 0;       ///< that centre, in the plane of the DEM
  double rmse_m = 0;                 ///< each cell once
  CellFault violations;              ///< further off than the bound
  CellFault uncovered;               ///< valid, in or on no triangle
  CellFault covered_voids;           ///< void, in or on a triangle
  CellFault folds;                   ///< strictly inside one triangle, and in or on another
  MeshFault outside;                 ///< vertices beyond the rectangle of the outermost cell centres
  MeshFault degenerate;              ///< triangles without area, in the plane
  MeshFault clockwise;               ///< triangles that face the ground
  double area_cells = 0;             ///< sum of the areas of all triangles, in cells
  double domain_cells = 0;           ///< area of the squares of the valid cells within the rectangle of the outermost cell centres
  int area_sign = 0;                 ///< the sign of area - domain, exactly
  MeshTopology topology;
  MeshFault t_junctions, cracks;

  double psnr_db() const;            ///< 20 log10((high - low) / RMSE); +infinity where the RMSE is 0
};

/// Compares every cell whose centre lies in or on a triangle, checks that the triangles tile the domain of the DEM - the union of the
/// squares of its valid cells, within the rectangle of the outermost cell centres - and that they hang together. Shares no code with
/// what makes meshes.
///
/// Guarantees: 1. what lies in or on a triangle, and on which side of an edge, is decided without rounding, of vertices placed by
/// RasterPlane. 2. A cell is a violation exactly where |height - elevation| > bound, for the heights as doubles: no tolerance,
/// and no cell is refused whose error is the bound. Areas are compared exactly. 3. The result is the same for any memory.
///
/// Memory: scratch.memory_bytes, beyond it files in scratch.folder (24 bytes per vertex, one per cell); and a row of tiles of 256
/// cells, and the border (seams.h). One thread. Throws Error{input} where the mesh does not fit the DEM (RasterPlane) or is damaged.
MeshErrors check_mesh(const MeshSource& mesh, const MeshFrame& frame, const RasterSource& dem, const GeoReference& geo,
                      const MeshCheckOptions& options, Progress& progress);

/// What is wrong, a line for each kind of fault, with the number and the first place; empty: the mesh keeps its bound and is sound. Vertices
/// of no triangle, and how many components and borders there are, are no faults.
std::vector<std::string> faults_of(const MeshErrors& errors, const MeshCheckOptions& options);

}  // namespace arete
