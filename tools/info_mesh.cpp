#include <cmath>

#include <fmt/format.h>

#include "gis/crs.h"
#include "gis/mesh/measure_mesh.h"
#include "gis/mesh/topology.h"
#include "tools/info.h"
#include "tools/mesh_input.h"
#include "tools/mesh_report.h"

namespace arete::tools {
namespace {

using nlohmann::json;

json to_json(const MeshVertex& v) { return {{"x", v.x}, {"y", v.y}, {"z", v.z}}; }

std::string name_of(const std::string& name, const std::string& authority) { return authority.empty() ? name : name + " (" + authority + ")"; }

std::string area_text(double area_m2) {
  return area_m2 >= 1e6 ? fmt::format("{:.6g} km2", area_m2 / 1e6) : fmt::format("{:.6g} m2", area_m2);
}

std::string unit_text(const MeshFrame& frame) {
  return frame.metres_per_unit == 1 ? frame.vertical_unit : fmt::format("{} ({:.10g} m)", frame.vertical_unit, frame.metres_per_unit);
}

}  // namespace

FileReport describe_mesh(const InfoOptions& options, const CommonOptions& common) {
  const auto progress = make_progress(common);
  const MeshFile file = read_mesh(options.file, temporary_scratch(common, 4));
  const MeshMeasures measures = measure_mesh(file.mesh, file.frame, *progress);
  const FileReport topology = describe_topology(mesh_topology(file.mesh, common.memory_bytes / 2, *progress));
  const CrsSummary crs = summarise_crs(file.frame.crs_wkt);
  const MeshVertex &low = measures.bounds.low, &high = measures.bounds.high;

  FileReport said;
  const auto line = [&](const char* label, const std::string& value) { said.text += fmt::format("{:<14} {}\n", label, value); };
  line("File", options.file);
  line("Format", file.format);
  line("Triangles", grouped(file.mesh.triangles()));
  line("Vertices", grouped(file.mesh.vertices()));
  line("CRS", crs.name.empty() ? "unknown" : name_of(crs.name, crs.authority));
  line("Vertical CRS", crs.vertical_name.empty() ? "not stated" : name_of(crs.vertical_name, crs.vertical_authority));
  line("Unit", unit_text(file.frame));
  line("X", fmt::format("{:.10g} .. {:.10g}", low.x, high.x));
  line("Y", fmt::format("{:.10g} .. {:.10g}", low.y, high.y));
  line("Z", fmt::format("{:.10g} .. {:.10g}", low.z, high.z));
  line("Area", area_text(measures.area_m2));
  line("Topology", topology.text);
  said.data = {{"kind", "mesh"},
               {"file", options.file},
               {"format", file.format},
               {"vertices", file.mesh.vertices()},
               {"triangles", file.mesh.triangles()},
               {"crs", {{"name", crs.name}, {"authority", crs.authority}, {"wkt", file.frame.crs_wkt}}},
               {"vertical_crs", {{"name", crs.vertical_name}, {"authority", crs.vertical_authority}}},
               {"vertical_unit", {{"name", file.frame.vertical_unit}, {"metres", file.frame.metres_per_unit}}},
               {"bounds", {{"low", to_json(low)}, {"high", to_json(high)}}},
               {"elevation_m", {{"min", measures.low_m}, {"max", measures.high_m}}},
               {"area_m2", measures.area_m2}};
  said.data.update(topology.data);
  return said;
}

}  // namespace arete::tools
