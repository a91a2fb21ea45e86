#pragma once

#include <string>

#include "core/support/scratch.h"
#include "gis/mesh/mesh_format.h"

namespace arete {

/// NetCDF with the UGRID 1.0 conventions (`.nc`; https://ugrid-conventions.github.io), the form in which QGIS takes a mesh with its CRS.
/// A classic file with 64-bit offsets, beyond 4 GiB per variable with 64-bit data (CDF-5):
///  - `mesh2d` (cf_role mesh_topology), `mesh2d_node_x`, `_y` (double), `mesh2d_node_z` (double, standard_name altitude, location node),
///    `mesh2d_face_nodes` (int, face x 3, start_index 0);
///  - the CRS in the variable `projected_coordinate_system`, or `wgs84` where it is geographic, the two names that MDAL looks for, as
///    crs_wkt (CF), spatial_ref (GDAL), wkt and epsg (MDAL).

/// None: coordinates are doubles.
MeshRounding ugrid_rounding(const MeshBounds& bounds, const MeshWriteOptions& options);

/// Throws Error{format} beyond 2^31 - 1 vertices or triangles, or for a mesh without triangles; Error{disk} where writing fails.
void write_ugrid(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options);

/// The first 2D topology of a file, of whoever made it; faces of more than three corners are cut into a fan. Without z it lies at 0.
/// Throws Error{input} where it is damaged, Error{format} where it is NetCDF without a mesh.
MeshFile read_ugrid(const std::string& path, const Scratch& scratch = {});

}  // namespace arete
