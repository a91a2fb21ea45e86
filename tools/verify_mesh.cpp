#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gis/mesh/check_mesh.h"
#include "gis/mesh/measure_mesh.h"
#include "gis/mesh/topology.h"
#include "tools/elevation_input.h"
#include "tools/mesh_input.h"
#include "tools/mesh_report.h"
#include "tools/verify.h"

namespace arete::tools {
namespace {

constexpr double georeferencing_cells = 1e-6;  // vertices at half cells come back to this

/// How far from a half cell a vertex may lie that was there before its format rounded it.
double snap_for(const MeshFile& file, const MeshBounds& bounds, Size cells) {
  constexpr double most = 0.2;
  const MeshFormat* format = format_named(file.format);
  if (format == nullptr || format->rounding == nullptr) return georeferencing_cells;
  const double extent = std::hypot(bounds.high.x - bounds.low.x, bounds.high.y - bounds.low.y);
  const double cell = extent / std::hypot(static_cast<double>(cells.width), static_cast<double>(cells.height));
  return cell > 0 ? std::clamp(2 * format->rounding(bounds, {}).horizontal / cell, georeferencing_cells, most) : georeferencing_cells;
}

/// Whether the mesh is sound is asked of vertices that are back where they were before their format rounded them: cells on edges would
/// else lie on neither side. Errors are those of the vertices as the file states them.
MeshErrors check_rounded(const MeshFile& file, const ElevationInput& dem, const MeshCheckOptions& how, Progress& progress) {
  MeshErrors errors = check_mesh(file.mesh, file.frame, *dem.source, dem.geo, how, progress);
  if (how.snap_cells <= georeferencing_cells) return errors;
  MeshCheckOptions as_stated = how;
  as_stated.snap_cells = georeferencing_cells;
  const MeshErrors stated = check_mesh(file.mesh, file.frame, *dem.source, dem.geo, as_stated, progress);
  if (stated.compared_cells == 0) return errors;
  errors.max_error_m = stated.max_error_m, errors.max_column = stated.max_column, errors.max_row = stated.max_row;
  errors.max_x = stated.max_x, errors.max_y = stated.max_y;
  errors.rmse_m = stated.rmse_m;
  if (stated.violations.count > 0) errors.violations = stated.violations;
  return errors;
}

FileReport check_against(const MeshFile& file, const VerifyOptions& options, const CommonOptions& common, Progress& progress) {
  const ElevationInput dem = open_elevations(options.original, options.dem, common.threads);
  limit_block_cache(common.memory_bytes / 8);
  if (file.frame.crs_wkt.empty() && !dem.geo.crs_wkt.empty())
    warn(common, "'" + options.file + "' names no CRS: its coordinates are taken for those of '" + options.original + "'");
  MeshCheckOptions how;
  how.max_error_m = options.max_error_m;
  how.allow_uncovered = options.clipped;
  how.snap_cells = snap_for(file, measure_mesh(file.mesh, file.frame, progress).bounds, dem.source->size());
  how.scratch = temporary_scratch(common, 2);
  const MeshErrors errors = check_rounded(file, dem, how, progress);
  const std::vector<std::string> faults = faults_of(errors, how);
  if (options.max_error_m && !faults.empty())
    throw Error(ErrorKind::damaged, fmt::format("'{}' is no mesh of '{}' within {} m: {}", options.file, options.original, *options.max_error_m, fmt::join(faults, "; ")));
  FileReport said = describe_mesh_errors(errors, how);
  said.data["snap_cells"] = how.snap_cells;
  if (options.max_error_m) {
    said.text += fmt::format("bound of {} m: kept\n", *options.max_error_m);
    said.data["kept"] = true;
  }
  return said;
}

}  // namespace

FileReport verify_mesh(const VerifyOptions& options, const CommonOptions& common) {
  const auto progress = make_progress(common);
  const MeshFile file = read_mesh(options.file, temporary_scratch(common, 4));
  FileReport said;
  said.text = fmt::format("{}: {}, {} triangles, {} vertices\n", options.file, file.format, grouped(file.mesh.triangles()), grouped(file.mesh.vertices()));
  said.data = {{"file", options.file}, {"format", file.format}, {"vertices", file.mesh.vertices()}, {"triangles", file.mesh.triangles()}};
  FileReport found;
  if (options.original.empty()) {
    found = describe_topology(mesh_topology(file.mesh, common.memory_bytes / 2, *progress));
    found.text += "\n";
  } else {
    found = check_against(file, options, common, *progress);
  }
  said.text += found.text;
  said.data.update(found.data);
  return said;
}

}  // namespace arete::tools
