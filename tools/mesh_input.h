#pragma once

#include <string>

#include "core/support/scratch.h"
#include "gis/mesh/mesh_format.h"
#include "tools/command.h"

namespace arete::tools {

/// Whether a file is to be read as a mesh: by its name; where GDAL opens it as a DEM (rasters have the extensions of some meshes), by
/// what is in it.
bool is_mesh_file(const std::string& path);

/// Files without a name in the folder for temporary files, beyond that share of the verb's memory.
Scratch temporary_scratch(const CommonOptions& common, int share);

/// The format that read it, or null.
const MeshFormat* format_named(const std::string& name);

}  // namespace arete::tools
