#pragma once

#include <string>

#include "core/support/scratch.h"
#include "gis/mesh/mesh_format.h"

namespace arete {

/// Meshes as a layer of features, through OGR: GeoPackage (`.gpkg`) and FlatGeobuf (`.fgb`).
///
/// Each feature is a TIN (OGC Simple Features 1.2.1, TIN Z) of up to 10,000 triangles that follow each other in the mesh: one TIN of
/// all would have to fit into memory, one feature per triangle would take 200 bytes and an index entry each, and blocks can be found by
/// place. GDAL reads them as TIN, QGIS 3.22 as MultiPolygonZ. Attributes: `block` (from 0), `triangles`, `z_unit`, `z_low`, `z_high`.
/// The CRS is written with its vertical part. Both have a spatial index; that of FlatGeobuf is made from a temporary file beside the
/// output.

/// None: coordinates are doubles.
MeshRounding tin_layer_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// The same mesh gives the same bytes: the date of change in a GeoPackage is 2000-01-01. Throws Error{disk} where writing fails.
void write_geopackage(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);
void write_flatgeobuf(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// All triangles of all layers, of whoever made them: TINs, polyhedral surfaces, and polygons of three corners without holes. Vertices
/// with equal coordinates are one; triangles are turned counter-clockwise, unless the CRS is geocentric. Throws Error{input} where it is
/// damaged, Error{format} where it holds no triangles, or other geometries beside them.
MeshFile read_geopackage(const std::string& path, const Scratch& scratch = {});
MeshFile read_flatgeobuf(const std::string& path, const Scratch& scratch = {});

}  // namespace arete
