#include "gis/mesh/mesh_format.h"

#include <algorithm>
#include <filesystem>

#include "core/support/error.h"
#include "gis/mesh/dxf.h"
#include "gis/mesh/gltf.h"
#include "gis/mesh/landxml.h"
#include "gis/mesh/obj.h"
#include "gis/mesh/ply.h"
#include "gis/mesh/stl.h"
#include "gis/mesh/tin_layer.h"
#include "gis/mesh/two_dm.h"
#include "gis/mesh/ugrid.h"

namespace arete {
namespace {

using Reader = MeshFile (*)(const std::string& path, const Scratch& scratch);

struct Entry {
  MeshFormat format;
  Reader read;
};

constexpr bool metres = true, any_units = false;
constexpr bool normals = true, no_normals = false;
constexpr bool texture = true, no_texture = false;

/// One line per format: name, extensions, description; what it holds; how far it moves vertices; its writer and its reader.
const std::vector<Entry>& entries() {
  // clang-format off
  static const std::vector<Entry> all = {
      {{"PLY", {".ply"}, "PLY, binary, exact (MeshLab, CloudCompare, Blender, QGIS)", any_units, normals, no_texture, ply_rounding, write_ply, {".prj"}}, read_ply},
      {{"OBJ", {".obj"}, "Wavefront OBJ with an offset file (3D modelling, games)", metres, normals, texture, obj_rounding, write_obj, {".prj", "_offset.xyz", ".mtl"}}, read_obj},
      {{"STL", {".stl"}, "STL, binary, 32-bit floats with an offset file (3D printing)", metres, no_normals, no_texture, stl_rounding, write_stl, {".prj", "_offset.xyz"}}, read_stl},
      {{"2DM", {".2dm"}, "SMS 2DM, exact (hydraulic models, QGIS)", any_units, no_normals, no_texture, two_dm_rounding, write_2dm, {".prj"}}, read_2dm},
      {{"DXF", {".dxf"}, "AutoCAD DXF R12, 3DFACE entities, exact (CAD)", metres, no_normals, no_texture, dxf_rounding, write_dxf, {".prj"}}, read_dxf},
      {{"LandXML", {".xml", ".landxml"}, "LandXML 1.2, a TIN surface, exact (civil engineering)", metres, no_normals, no_texture, landxml_rounding, write_landxml}, read_landxml},
      {{"glTF", {".glb", ".gltf"}, "glTF 2.0, 32-bit floats to a millimetre anywhere (Blender, Cesium, browsers)", metres, normals, texture, gltf_rounding, write_gltf}, read_gltf},
      {{"UGRID", {".nc"}, "NetCDF UGRID 1.0 with its CRS, exact (QGIS mesh layers)", any_units, no_normals, no_texture, ugrid_rounding, write_ugrid}, read_ugrid},
      {{"GeoPackage", {".gpkg"}, "GeoPackage, a layer of TINs, exact (any GIS)", any_units, no_normals, no_texture, tin_layer_rounding, write_geopackage}, read_geopackage},
      {{"FlatGeobuf", {".fgb"}, "FlatGeobuf, a layer of TINs, exact (any GIS, the web)", any_units, no_normals, no_texture, tin_layer_rounding, write_flatgeobuf}, read_flatgeobuf},
  };
  // clang-format on
  return all;
}

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

const Entry* entry_of(const std::string& path) {
  const std::string extension = lower_extension(path);
  for (const Entry& entry : entries())
    if (std::count(entry.format.extensions.begin(), entry.format.extensions.end(), extension) > 0) return &entry;
  return nullptr;
}

const Entry& known_entry_of(const std::string& path) {
  if (const Entry* entry = entry_of(path)) return *entry;
  std::string known;
  for (const Entry& entry : entries())
    for (const std::string& extension : entry.format.extensions) known += (known.empty() ? "" : " ") + extension;
  throw Error(ErrorKind::format,
              "'" + path + "': no format of meshes has the extension '" + lower_extension(path) + "'; expected one of " + known);
}

}  // namespace

const std::vector<MeshFormat>& mesh_formats() {
  static const std::vector<MeshFormat> formats = [] {
    std::vector<MeshFormat> listed;
    for (const Entry& entry : entries()) listed.push_back(entry.format);
    return listed;
  }();
  return formats;
}

const MeshFormat& mesh_format_of(const std::string& path) {
  return mesh_formats()[static_cast<std::size_t>(&known_entry_of(path) - entries().data())];
}

MeshFile read_mesh(const std::string& path, const Scratch& scratch) { return known_entry_of(path).read(path, scratch); }

bool is_mesh_path(const std::string& path) { return entry_of(path) != nullptr; }

}  // namespace arete
