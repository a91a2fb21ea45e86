#include "tools/mesh_input.h"

#include <filesystem>

#include "gis/dem_file.h"

namespace arete::tools {
namespace {

/// Whether `act` succeeds.
template <class Act>
bool works(const Act& act) {
  try {
    act();
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool is_mesh_file(const std::string& path) {
  if (!is_mesh_path(path)) return false;
  const bool raster = works([&] { DemReader{path}; });
  return !raster || works([&] { read_mesh(path); });
}

Scratch temporary_scratch(const CommonOptions& common, int share) {
  std::error_code none;
  return {common.memory_bytes / share, std::filesystem::temp_directory_path(none).string()};
}

const MeshFormat* format_named(const std::string& name) {
  for (const MeshFormat& format : mesh_formats())
    if (format.name == name) return &format;
  return nullptr;
}

}  // namespace arete::tools
