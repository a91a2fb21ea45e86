#pragma once

#include <string>

#include "gis/mesh/mesh.h"

namespace arete {

/// What lies beside a mesh of a format that has no room for it.

/// Writes `<name>.prj` beside `<name>.ply`: the CRS in the WKT of Esri, which every GIS reads; in WKT 1 of OGC where that has no
/// word for it (geocentric), else WKT 2. Nothing where the CRS is unknown. Throws Error{disk}.
void write_prj(const MeshFrame& frame, const std::string& mesh_path);

/// The CRS beside a mesh, and with it the vertical unit where it states one; a frame without a CRS where there is no such file or
/// it holds no CRS that is known.
MeshFrame read_prj(const std::string& mesh_path);

/// WKT 2 of a CRS given as WKT of any kind, by its name in EPSG where it is surely the same; empty where it is none that is
/// known.
std::string wkt2_of(const std::string& wkt);
/// WKT 1 of OGC, which older readers know; the text itself where WKT 1 has no word for it.
std::string wkt1_of(const std::string& wkt);

/// "ft = 0.3048 m": the vertical unit in a comment, behind the word vertical_unit.
std::string vertical_unit_text(const MeshFrame& frame);
/// The inverse; leaves the frame as it is where the text is none of this form.
void parse_vertical_unit(const std::string& text, MeshFrame& frame);

/// What was subtracted from the coordinates in a file: whole units, near the middle of the mesh. An axis whose coordinates all
/// lie within +-16384 has none (0): a float32 holds them to half a millimetre.
MeshVertex mesh_offset(const MeshBounds& bounds);

/// Writes `<name>_offset.xyz` beside `<name>.obj`, as Pix4D does: one line "x y z", to be added to each vertex. Nothing where all
/// are 0. Throws Error{disk}.
void write_offset(const MeshVertex& offset, const std::string& mesh_path);

/// Zeros where there is no such file. Throws Error{input} where it does not hold three numbers.
MeshVertex read_offset(const std::string& mesh_path);

/// How far coordinates from `low` to `high` move when `offset` is subtracted in double and added again: 0 where both are exact,
/// else one unit in the last place of the largest difference. Derivation in the source.
double offset_rounding(double low, double high, double offset);

}  // namespace arete
