#pragma once

#include "gis/mesh/mesh_format.h"

namespace arete {

/// LandXML 1.2 (LandXML.org, 2008): one Surface, surfType TIN, points as "northing easting elevation", in metres, the CRS in
/// CoordinateSystem. The date that the schema asks for is 1970-01-01: the same mesh gives the same bytes. Throws Error{format}
/// where z is not in metres, as MeshFormat::write else.
void write_landxml(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// Nothing moves: 0.
MeshRounding landxml_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// The one surface of a file, without its invisible faces (i="1"). The vertical unit is that of Units. Throws as read_mesh, and
/// Error{input} where there are several surfaces or one is no TIN.
MeshFile read_landxml(const std::string& path, const Scratch& scratch);

}  // namespace arete
