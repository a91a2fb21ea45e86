#pragma once

#include "core/support/progress.h"
#include "core/terrain/georeference.h"
#include "core/terrain/raster_io.h"
#include "gis/image.h"
#include "gis/mesh/mesh.h"
#include "gis/tin/placed_mesh.h"

namespace arete {

/// A picture to drape over a mesh, and where its outer edges lie in the plane of the mesh.
struct Drape {
  Picture picture;
  MeshBounds bounds;  ///< x and y only
};

/// The relief map of a raster (draw_relief, without legend) in the plane of its mesh: the raster is warped where that is another one than
/// its own. The longest side has 2048 pixels at most. Throws Error{usage} where the mesh lies in no plane (geocentric coordinates).
Drape draw_drape(const RasterSource& raster, const GeoReference& geo, const PlacedMesh& mesh, int threads, Progress& progress);

}  // namespace arete
