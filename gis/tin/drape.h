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
/// its own. The longest side has 2048 pixels at most. Of the mesh its plane alone counts. Throws Error{usage} where the mesh lies in no plane
/// (geocentric coordinates).
Drape draw_drape(const RasterSource& raster, const GeoReference& geo, const PlacedMesh& mesh, int threads, Progress& progress);

/// A picture that covers a raster, from outer edge to outer edge of its cells, row 0 on top of the first row: as it is where the mesh lies in
/// the plane of a raster with north up; else warped into that plane, transparent beside the raster, the longest side 8192 pixels at
/// most. Throws as draw_drape, and Error{input} where the raster's CRS cannot be related to that of the mesh.
Drape drape_picture(const Picture& picture, const GeoReference& geo, Size raster, const PlacedMesh& mesh);

}  // namespace arete
