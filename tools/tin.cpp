#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "gis/crs.h"
#include "gis/dem_file.h"
#include "gis/image.h"
#include "gis/mesh/mesh_format.h"
#include "gis/staged_files.h"
#include "gis/tin/drape.h"
#include "gis/tin/make_tin.h"
#include "gis/tin/placed_mesh.h"
#include "gis/tin/read_lines.h"
#include "gis/tin/tin_goal.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/elevation_input.h"
#include "tools/mesh_report.h"
#include "tools/tin_tiles.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct TinArguments {
  std::string input, output, crs, breaklines, boundary;
  std::string drape;  ///< 'relief' or a picture; empty: none
  DemReadOptions dem;
  double max_error = 0, rmse = 0;
  std::int64_t max_triangles = 0;
  int level = 0, passes = 3;
  bool normals = false, draco = false, fill = false;
};

// Elevations on Earth, from which a format's rounding is foreseen before any is read.
constexpr double lowest_m = -11000, highest_m = 9000;
constexpr double least_error_m = 1e-4;

std::string target_crs(const std::string& name) {
  if (name.empty() || name == "utm") return "";
  return crs_wkt(name == "ecef" ? "EPSG:4978" : name);
}

/// What the format leaves of the bound, and the step of elevations that it holds exactly.
struct FormatBound {
  double taken_m = 0;          ///< of the bound, by rounding of elevations
  Displacement displacement;
  bool fixed_step = false;     ///< elevations must be multiples of 2^-10 m to come back exactly
};

FormatBound bound_of(const MeshFormat& format, const PlacedMesh& plane, const MeshWriteOptions& writing) {
  const MeshRounding rounding = format.rounding(plane.bounds_of_raster(lowest_m, highest_m), writing);
  FormatBound bound;
  bound.taken_m = plane.height_noise_m();
  bound.displacement = plane.displacement();
  bound.displacement.rounding_cells = rounding.horizontal / plane.cell_units();
  // glTF halves edges that are too long for its floats; in another plane than the DEM's, halves of the border would leave it.
  constexpr double longest_in_gltf = 4000;
  if (format.name == "glTF" && bound.displacement.longest_cells != any_length)
    bound.displacement.longest_cells = std::max(least_length, std::min(bound.displacement.longest_cells, longest_in_gltf / plane.cell_units()));
  bound.fixed_step = rounding.vertical > 0;
  const double vertical_m = rounding.vertical * plane.frame().metres_per_unit;
  // Half a step of 2^-10 m and less: the multiples of 2^-10 are among the numbers that the format has.
  if (vertical_m > 1.0 / 2048 || plane.height_noise_m() > 0) bound.taken_m += vertical_m;
  return bound;
}

Tin make(const RasterSource& raster, const TinArguments& arguments, TinOptions options, const FormatBound& format, Progress& progress) {
  if (format.fixed_step) options.height_step_m = 1.0 / 1024;
  if (arguments.max_error > 0) {
    const double least = std::max(least_error_m, format.taken_m + options.height_step_m);
    if (arguments.max_error < least)
      throw Error(ErrorKind::usage, fmt::format("--max-error {} m is finer than '{}' can hold: its smallest is {:.4g} m", arguments.max_error, arguments.output, least));
    options.max_error_m = arguments.max_error - format.taken_m;
    return make_tin(raster, options, progress);
  }
  options.max_error_m = 0;
  if (arguments.max_triangles > 0) return make_tin_of_triangles(raster, arguments.max_triangles, options, progress);
  return make_tin_of_rmse(raster, arguments.rmse, options, progress);
}

std::string describe(const TinArguments& arguments, const TinReport& report, double proven_m) {
  return fmt::format("{}: {} triangles, {} vertices: {:.3g} % of the full grid's {}\nproven: no cell is further off than {:.6g} m; RMSE {:.4g} m over {} cells\n",
                     arguments.output, grouped(report.triangles), grouped(report.vertices),
                     100.0 * static_cast<double>(report.triangles) / static_cast<double>(std::max<std::int64_t>(1, report.full_triangles)),
                     grouped(report.full_triangles), proven_m, report.rmse_m, grouped(report.cells));
}

/// Draws the relief, or takes the user's picture, and tells the writer of it: beside an OBJ, which names it, as its side file; for glTF, which
/// holds it, as scratch.
void add_drape(const TinArguments& arguments, const ElevationInput& input, const PlacedMesh& plane, const StagedFiles& staged, const MeshFormat& format,
               const CommonOptions& common, Progress& progress, MeshWriteOptions& writing) {
  const Drape drape = arguments.drape == "relief" ? draw_drape(*input.source, input.geo, plane, common.threads, progress)
                                                : drape_picture(read_picture(arguments.drape), input.geo, input.source->size(), plane);
  const std::filesystem::path beside = std::filesystem::path(staged.staged()).replace_extension(".png");
  writing.texture = format.name == "OBJ" ? beside.string() : staged.scratch("relief.png");
  writing.texture_bounds = drape.bounds;
  write_picture(writing.texture, drape.picture);
}

void make_tiles(const TinArguments& arguments, const CommonOptions& common) {
  if (!(arguments.max_error > 0)) throw Error(ErrorKind::usage, "tiles for Cesium are made within an error: give --max-error");
  if (!arguments.crs.empty() || arguments.normals || arguments.draco || !arguments.drape.empty())
    throw Error(ErrorKind::usage, "tiles for Cesium are in longitude and latitude, without normals or picture: leave --crs, --normals, --draco and --drape out");
  if (!arguments.breaklines.empty() || !arguments.boundary.empty())
    throw Error(ErrorKind::usage, "tiles for Cesium take no lines yet: leave --breaklines and --boundary out, or write another format");
  run_tin_tiles({arguments.input, arguments.output, arguments.dem, arguments.max_error, arguments.level, arguments.passes, arguments.fill}, common);
}

void warn_of(const LinesInRaster& lines, const std::string& file, const std::string& raster, const CommonOptions& common) {
  if (lines.crs_unknown) warn(common, fmt::format("one of '{}' and '{}' names no CRS: their coordinates are taken for those of the same", file, raster));
}

/// Lines in the raster. A boundary that does not meet it is an error, breaklines that do not are none.
TinLines read_lines(const TinArguments& arguments, const ElevationInput& input, const CommonOptions& common) {
  TinLines lines;
  const Size size = input.source->size();
  if (!arguments.breaklines.empty()) {
    LinesInRaster read = read_breaklines(arguments.breaklines, input.geo, size);
    warn_of(read, arguments.breaklines, arguments.input, common);
    if (read.lines.empty()) warn(common, fmt::format("none of the {} features of '{}' meets '{}': no breaklines", read.features, arguments.breaklines, arguments.input));
    lines.breaklines = std::move(read.lines);
  }
  if (!arguments.boundary.empty()) {
    LinesInRaster read = read_boundary(arguments.boundary, input.geo, size);
    warn_of(read, arguments.boundary, arguments.input, common);
    if (read.features_inside == 0) throw Error(ErrorKind::input, fmt::format("the boundary '{}' lies outside '{}': is its CRS right?", arguments.boundary, arguments.input));
    lines.boundary = std::move(read.lines);
  }
  return lines;
}

void run_tin(const TinArguments& arguments, const CommonOptions& common) {
  if (is_tile_set_path(arguments.output)) return make_tiles(arguments, common);
  if (arguments.fill) throw Error(ErrorKind::usage, "--fill is for tiles for Cesium; a mesh leaves voids open");
  const MeshFormat& format = mesh_format_of(arguments.output);
  if (arguments.normals && !format.holds_normals) throw Error(ErrorKind::usage, format.name + " holds no normals: leave --normals out, or write PLY, OBJ or glTF");
  if (arguments.draco && format.name != "glTF") throw Error(ErrorKind::usage, "--draco is of glTF: name the output .glb or .gltf");
  if (!arguments.drape.empty() && !format.holds_texture) throw Error(ErrorKind::usage, format.name + " holds no picture: leave --drape out, or write OBJ or glTF");
  StagedFiles staged(arguments.output, common.overwrite, format.side_endings);
  const ElevationInput input = open_elevations(arguments.input, arguments.dem, common.threads, arguments.level);
  limit_block_cache(common.memory_bytes / 8);

  MeshWriteOptions writing;
  writing.title = fmt::format("TIN of {} by arete {}", std::filesystem::path(arguments.input).filename().string(), ARETE_VERSION);
  writing.normals = arguments.normals;
  writing.compress = arguments.draco;
  writing.memory_bytes = common.memory_bytes / 4;
  const MeshPlacement placement{target_crs(arguments.crs), format.metric || arguments.crs == "utm", arguments.crs == "utm"};
  const MeshStore nothing;
  const PlacedMesh plane(nothing, input.geo, input.source->size(), placement);
  const FormatBound bound = bound_of(format, plane, writing);

  TinOptions options;
  options.passes = arguments.passes;
  options.displacement = bound.displacement;
  options.lines = read_lines(arguments, input, common);
  options.threads = common.threads;
  options.scratch = {common.memory_bytes / 4 * 3, std::filesystem::absolute(arguments.output).parent_path().string()};
  const auto progress = make_progress(common);
  if (!arguments.drape.empty()) add_drape(arguments, input, plane, staged, format, common, *progress, writing);
  const Tin tin = make(*input.source, arguments, options, bound, *progress);
  const PlacedMesh mesh(tin.mesh, input.geo, input.source->size(), placement);
  progress->begin("writing", 0);
  format.write(mesh, mesh.frame(), staged.staged(), writing);
  progress->end();
  staged.publish();

  const TinReport& report = tin.report;
  const double proven_m = (bound.displacement.any() ? report.bound_m : report.max_error_m) + bound.taken_m;
  print_result(common, describe(arguments, report, proven_m),
               {{"output", arguments.output}, {"format", format.name}, {"max_error_m", proven_m}, {"rmse_m", report.rmse_m}, {"vertices", report.vertices},
                {"triangles", report.triangles}, {"cells", report.cells}, {"full_triangles", report.full_triangles}, {"crs", summarise_crs(mesh.frame().crs_wkt).authority}});
}

}  // namespace

void add_tin(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<TinArguments>();
  CLI::App* verb = add_verb(app, "tin", "Turn a DEM or a tree (.sct) into a triangle mesh (TIN) whose vertical error is proven",
                            "arete tin dem.tif mesh.ply --max-error 5\narete tin dem.tif mesh.glb --max-triangles 100000 --normals\narete tin dem.tif dem.tiles --max-error 2\narete tin dem.tif mesh.ply --max-error 5 --breaklines rivers.gpkg --boundary area.gpkg", common,
                            [arguments, common] { run_tin(*arguments, *common); });
  std::string extensions, formats;
  for (const MeshFormat& format : mesh_formats()) {
    extensions += (extensions.empty() ? "" : " ") + fmt::format("{}", fmt::join(format.extensions, " "));
    formats += fmt::format("\n  {:<15} {}", fmt::format("{}", fmt::join(format.extensions, ", ")), format.description);
  }
  verb->footer(verb->get_footer() + "\n\nFormats:" + formats + "\n  .tiles          quantized-mesh tiles and layer.json, a folder (Cesium)");
  verb->add_option("IN", arguments->input, "The DEM, anything that GDAL opens, or a tree (.sct)")->required();
  verb->add_option("OUT", arguments->output, "The mesh, by its extension: " + extensions + "; or a folder of quantized-mesh tiles for Cesium: .tiles, or a name that ends in /")->required();
  CLI::Option_group* target = verb->add_option_group("target", "What the mesh must reach; one of them");
  target->add_option("--max-error", arguments->max_error, "No cell is further from the mesh than this, vertically, in metres")->check(above_zero());
  target->add_option("--max-triangles", arguments->max_triangles, "The most faithful mesh of at most this many triangles")->check(CLI::Range(std::int64_t{2}, std::int64_t{1} << 40));
  target->add_option("--rmse", arguments->rmse, "The smallest mesh with a root mean square error of at most this, in metres")->check(above_zero());
  target->require_option(1);
  verb->add_option("--crs", arguments->crs,
                   "Coordinates in this CRS: EPSG:32632, WKT, 'utm' (the zone that the DEM lies in) or 'ecef' (default: the DEM's; for OBJ, STL, DXF, LandXML and glTF of a "
                   "DEM in degrees: utm)");
  verb->add_option("--breaklines", arguments->breaklines,
                   "Lines that become edges of the mesh: rivers, roads, ridges, outlines of polygons; anything that OGR reads, in any CRS (FILE or 'FILE|LAYER')");
  verb->add_option("--boundary", arguments->boundary, "Polygons that the mesh is clipped to (FILE or 'FILE|LAYER'); check such a mesh with arete verify --clipped");
  verb->add_option("--level", arguments->level, "Of a tree: 0 is the raster; each level more halves the cells along each side")->check(CLI::Range(0, 40));
  verb->add_option("--passes", arguments->passes, "Passes of simplification: 0 leaves greedy insertion as it is, more than the default of 3 gain little")
      ->check(CLI::Range(0, 20));
  verb->add_flag("--normals", arguments->normals, "A normal for each vertex (PLY, OBJ, glTF)");
  verb->add_flag("--fill", arguments->fill, "Tiles for Cesium: ground at height 0 where the DEM has none, at the deepest level too, which else has holes there");
  verb->add_flag("--draco", arguments->draco, "Compress with Draco (glTF)");
  verb->add_option("--drape", arguments->drape,
                   "What lies over it (OBJ, glTF): 'relief', the shaded relief map, or a picture of your own that covers the DEM to the edges of its cells");
  add_dem_options(verb, arguments->dem);
}

}  // namespace arete::tools
