#pragma once

#include "core/support/progress.h"
#include "core/support/scratch.h"
#include "gis/mesh/mesh.h"
#include "gis/relief.h"

namespace arete {

struct MeshDrawOptions {
  ReliefOptions relief;     ///< relief.width 0: the longest side of the map has 2048 pixels
  bool wireframe = true;    ///< the sides of the triangles over the relief
  Scratch scratch;          ///< for the vertices: 24 bytes each
};

/// Draws a mesh from above as draw_relief draws a raster: heights of the triangles, twice as fine as the pixels, under its colours and light;
/// what no triangle covers is hatched. Sides are dark lines of one pixel, smoothed 4 x 4 times; where they lie so dense that they would
/// hide the relief, they fade. North is up, in the CRS of the mesh (geocentric coordinates: in longitude and latitude); pixels are
/// square on the ground at the centre. low_m and high_m of the result are those of what is drawn. Memory: the picture (32 bytes per
/// pixel), and scratch. Throws Error{input} where the mesh has no extent, or names a vertex that it does not have.
Relief draw_mesh(const MeshSource& mesh, const MeshFrame& frame, const MeshDrawOptions& options, Progress& progress);

}  // namespace arete
