#include "tools/mesh_report.h"

#include <cmath>

#include <fmt/format.h>

namespace arete::tools {
namespace {

using nlohmann::json;

json finite(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json to_json(const CellFault& fault) {
  json data = {{"cells", fault.count}};
  if (fault.count > 0) data["first"] = {{"column", fault.column}, {"row", fault.row}};
  return data;
}

json to_json(const MeshFault& fault) {
  json data = {{"count", fault.count}};
  if (fault.count > 0) data["first"] = fault.first;
  return data;
}

std::string errors_text(const MeshErrors& errors) {
  if (errors.compared_cells == 0) return "no valid cell lies in a triangle\n";
  std::string text = fmt::format("largest error {:.9g} m at column {}, row {} (x {:.10g}, y {:.10g}); RMSE {:.4g} m", errors.max_error_m, errors.max_column, errors.max_row,
                                 errors.max_x, errors.max_y, errors.rmse_m);
  if (errors.rmse_m > 0) text += fmt::format(", PSNR {:.2f} dB (peak {:.6g} m)", errors.psnr_db(), errors.high_m - errors.low_m);
  return text + "\n";
}

std::string area_text(const MeshErrors& errors) {
  if (errors.area_sign == 0) return fmt::format("covers {:.10g} cells, exactly the domain of the DEM\n", errors.area_cells);
  return fmt::format("covers {:.10g} cells; the domain of the DEM has {:.10g}\n", errors.area_cells, errors.domain_cells);
}

}  // namespace

std::string grouped(std::int64_t count) {
  std::string text = std::to_string(count);
  for (auto at = static_cast<std::int64_t>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

FileReport describe_topology(const MeshTopology& topology) {
  FileReport said;
  said.text = fmt::format("{} edges, {} of them on the border; {}", grouped(topology.edges), grouped(topology.border_edges),
                          topology.non_manifold_edges == 0 ? "manifold" : grouped(topology.non_manifold_edges) + " not manifold");
  if (topology.components) said.text += fmt::format("; {} {}", grouped(*topology.components), *topology.components == 1 ? "part" : "parts");
  if (topology.unused_vertices > 0) said.text += fmt::format("; {} vertices are of no triangle", grouped(topology.unused_vertices));
  said.data = {{"edges", topology.edges},
               {"border_edges", topology.border_edges},
               {"non_manifold_edges", topology.non_manifold_edges},
               {"manifold", topology.non_manifold_edges == 0},
               {"unused_vertices", topology.unused_vertices},
               {"components", topology.components ? json(*topology.components) : json(nullptr)}};
  return said;
}

FileReport describe_mesh_errors(const MeshErrors& errors, const MeshCheckOptions& options) {
  const FileReport topology = describe_topology(errors.topology);
  const std::vector<std::string> faults = faults_of(errors, options);
  FileReport said;
  said.text = errors_text(errors);
  said.text += fmt::format("{} of {} valid cells compared", grouped(errors.compared_cells), grouped(errors.valid_cells));
  if (options.max_error_m) said.text += fmt::format(", {} of them further off than {} m", grouped(errors.violations.count), *options.max_error_m);
  said.text += "\n" + area_text(errors) + topology.text + "\n";
  for (const std::string& fault : faults) said.text += "fault: " + fault + "\n";
  said.data = topology.data;
  said.data.update({{"cells", errors.cells},
                    {"valid_cells", errors.valid_cells},
                    {"compared_cells", errors.compared_cells},
                    {"max_error_m", finite(errors.max_error_m)},
                    {"rmse_m", finite(errors.rmse_m)},
                    {"psnr_db", finite(errors.psnr_db())},
                    {"peak_m", finite(errors.high_m - errors.low_m)},
                    {"violations", to_json(errors.violations)},
                    {"uncovered", to_json(errors.uncovered)},
                    {"covered_voids", to_json(errors.covered_voids)},
                    {"folds", to_json(errors.folds)},
                    {"outside", to_json(errors.outside)},
                    {"degenerate", to_json(errors.degenerate)},
                    {"clockwise", to_json(errors.clockwise)},
                    {"t_junctions", to_json(errors.t_junctions)},
                    {"cracks", to_json(errors.cracks)},
                    {"area_cells", errors.area_cells},
                    {"domain_cells", errors.domain_cells},
                    {"area_exact", errors.area_sign == 0},
                    {"faults", faults}});
  if (errors.compared_cells > 0)
    said.data["max_error_at"] = {{"column", errors.max_column}, {"row", errors.max_row}, {"x", errors.max_x}, {"y", errors.max_y}};
  if (options.max_error_m) said.data["bound_m"] = *options.max_error_m;
  return said;
}

}  // namespace arete::tools
