#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gis/colour_ramp.h"
#include "gis/geodesy.h"
#include "gis/mesh/draw_mesh.h"
#include "gis/relief.h"
#include "tools/command.h"
#include "tools/drawn_terrain.h"
#include "tools/elevation_input.h"
#include "tools/mesh_input.h"
#include "tools/preview_page.h"
#include "tools/preview_perspective.h"
#include "tools/preview_profile.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

/// What a picture can be: a view, or a page.
enum Kind : unsigned { top = 1, perspective = 2, profile = 4, page = 8 };

struct PreviewArguments {
  std::string input, output, compare, view = "top", ramp = "land", azimuth = "multi", credit;
  std::vector<double> line;
  std::int64_t width = 0;
  double exaggeration = 0;
  bool no_legend = false, no_wireframe = false, terrain_rgb = false;
  int band = 1;
  PerspectiveArguments perspective;
  GroundArguments ground;
  std::vector<std::pair<const CLI::Option*, unsigned>> options;  ///< and the kinds that take them

  Kind kind() const { return is_page(output) ? page : view == "profile" ? profile : view == "perspective" ? Kind::perspective : top; }
};

std::string name_of(Kind kind) { return kind == page ? "pages (.html)" : kind == profile ? "--view profile" : kind == perspective ? "--view perspective" : "--view top"; }

/// Throws Error{usage} where an option is given that this picture does not take.
void check_options(const PreviewArguments& arguments) {
  for (const auto& [option, kinds] : arguments.options) {
    if (option->count() == 0 || (kinds & arguments.kind()) != 0) continue;
    std::string takers;
    for (const Kind kind : {top, perspective, profile, page})
      if ((kinds & kind) != 0) takers += (takers.empty() ? "" : ", ") + name_of(kind);
    throw Error(ErrorKind::usage, option->get_name() + " is not for " + name_of(arguments.kind()) + ", but for " + takers);
  }
}

std::optional<double> parse_azimuth(const std::string& text) {
  if (text == "multi") return std::nullopt;
  std::size_t read = 0;
  double degrees = 0;
  try {
    degrees = std::stod(text, &read);
  } catch (const std::exception&) {
    read = 0;
  }
  if (read != text.size() || text.empty() || !(degrees >= 0 && degrees <= 360))
    throw Error(ErrorKind::usage, "--azimuth takes 'multi' or degrees from 0 to 360, not '" + text + "'");
  return degrees;
}

/// The options that both views share, as this one takes them.
PerspectiveArguments perspective_of(const PreviewArguments& arguments) {
  PerspectiveArguments perspective = arguments.perspective;
  perspective.input = arguments.input;
  perspective.output = arguments.output;
  perspective.ramp = arguments.ramp;
  perspective.exaggeration = arguments.exaggeration;
  perspective.sun_azimuth_deg = parse_azimuth(arguments.azimuth).value_or(315);
  perspective.legend = !arguments.no_legend;
  perspective.ground = arguments.ground;
  perspective.dem = {.band = arguments.band, .terrain_rgb = arguments.terrain_rgb};
  return perspective;
}

Relief draw_dem(const PreviewArguments& arguments, ReliefOptions options, Progress& progress) {
  const ElevationInput dem = open_elevations(arguments.input, {.band = arguments.band, .terrain_rgb = arguments.terrain_rgb}, options.threads);
  options.metric = dem.geo.transform.has_value();
  if (!arguments.ground.drape.empty()) options.cover = ReliefCover{arguments.ground.drape, {arguments.input, dem.geo, dem.source->size()}};
  return draw_relief(*dem.source, cell_size(dem.geo, dem.source->size()), options, progress);
}

Relief draw_mesh_file(const PreviewArguments& arguments, const ReliefOptions& relief, const CommonOptions& common, Progress& progress) {
  const MeshFile file = read_mesh(arguments.input, temporary_scratch(common, 4));
  MeshDrawOptions options;
  options.relief = relief;
  options.relief.metric = !file.frame.crs_wkt.empty();
  options.wireframe = !arguments.no_wireframe;
  options.scratch = temporary_scratch(common, 2);
  return draw_mesh(file.mesh, file.frame, options, progress);
}

void run_preview(const PreviewArguments& arguments, const CommonOptions& common) {
  limit_block_cache(common.memory_bytes / 4);
  check_options(arguments);
  if (arguments.kind() == profile) {
    if (is_mesh_file(arguments.input)) throw Error(ErrorKind::usage, "profiles are drawn of DEMs and trees, not of meshes: '" + arguments.input + "'");
    return run_preview_profile({arguments.input, arguments.output, arguments.ramp, {.band = arguments.band, .terrain_rgb = arguments.terrain_rgb}, arguments.line,
                                arguments.width, arguments.exaggeration}, common);
  }
  ReliefOptions options;
  options.ramp = arguments.ramp;
  options.width = arguments.width;
  options.exaggeration = arguments.exaggeration;
  options.azimuth_deg = parse_azimuth(arguments.azimuth);
  options.legend = !arguments.no_legend;
  options.threads = common.threads;
  options.style = ground_style(arguments.ground);
  if (arguments.kind() == page) {
    write_preview_page({.input = arguments.input, .output = arguments.output, .compare = arguments.compare,
                        .reading = {.band = arguments.band, .terrain_rgb = arguments.terrain_rgb}, .relief = options, .legend = options.legend,
                        .credit = arguments.credit},
                       common);
    return;
  }
  if (arguments.kind() == perspective) return draw_perspective(perspective_of(arguments), common);
  check_picture_path(arguments.output, common.overwrite);
  if (options.legend) warn_without_font(common);

  if (!arguments.ground.drape.empty() && is_mesh_file(arguments.input))
    throw Error(ErrorKind::usage, "--drape lies over DEMs and trees (.sct), '" + arguments.input + "' is a mesh");
  const auto progress = make_progress(common);
  const Relief relief = is_mesh_file(arguments.input) ? draw_mesh_file(arguments, options, common, *progress) : draw_dem(arguments, options, *progress);
  write_picture(arguments.output, relief.picture, common.overwrite);

  if (std::isnan(relief.low_m)) warn(common, "'" + arguments.input + "' has no valid cell");
  char range[96] = "no elevation";
  if (!std::isnan(relief.low_m)) std::snprintf(range, sizeof range, "%.1f to %.1f m", relief.low_m, relief.high_m);
  char text[256];
  std::snprintf(text, sizeof text, ": %lld x %lld pixels of %.4g m, elevations %s, relief exaggerated %g times\n",
                static_cast<long long>(relief.picture.width()), static_cast<long long>(relief.picture.height()),
                relief.metres_per_pixel, range, relief.exaggeration);
  const auto finite = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); };
  print_result(common, arguments.output + text,
               {{"picture", arguments.output}, {"width", relief.picture.width()}, {"height", relief.picture.height()},
                {"metres_per_pixel", relief.metres_per_pixel}, {"low_m", finite(relief.low_m)}, {"high_m", finite(relief.high_m)},
                {"exaggeration", relief.exaggeration}, {"contour_interval_m", relief.contour_interval_m}});
}

}  // namespace

void add_preview(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<PreviewArguments>();
  CLI::App* verb = add_verb(app, "preview", "Draw a DEM or a mesh as a shaded relief map, in perspective, as a profile, or as a page to turn about in a browser",
                            "arete preview dem.tif relief.png\narete preview mesh.ply mesh.png\narete preview dem.tif view.png --view perspective --look-from 200\n"
                            "arete preview dem.tif view.tif --view perspective --eye 783000,186000,+300 --look-at 785000,189000\n"
                            "arete preview mesh.ply view.png --view perspective --style wireframe\n"
                            "arete preview dem.tif profile.png --view profile --line 782000,186000,785000,189000\n"
                            "arete preview dem.tif page.html --compare finer.tif",
                            common, [arguments, common] { run_preview(*arguments, *common); });
  verb->add_option("IN", arguments->input, "The DEM: anything that GDAL opens; a tree (.sct); or a mesh (.ply...)")->required();
  verb->add_option("OUT", arguments->output, "The picture: .png, .tif, .exr (in perspective of 8 bits, 16 bits, and linear half floats of the scene's light, without legend); or a page for a "
                   "browser that needs no network: .html")->required();
  const auto of = [arguments](CLI::Option* option, unsigned kinds) {
    arguments->options.emplace_back(option, kinds);
    return option;
  };
  of(verb->add_option("--compare", arguments->compare, "Page: another DEM of the same ground, right of a divider that can be moved"), page);
  of(verb->add_option("--view", arguments->view, "What is drawn: 'top', the map (default); 'perspective', the terrain as a camera sees it; or 'profile', the elevations under a line"), top | perspective | profile)
      ->check(CLI::IsMember({"top", "perspective", "profile"}));
  of(verb->add_option("--line", arguments->line, "Where the profile runs, X1,Y1,X2,Y2 in the CRS of the DEM (default: through the middle, from left to right)"), profile)
      ->delimiter(',')
      ->expected(4);
  for (CLI::Option* option : add_perspective_options(verb, arguments->perspective)) of(option, perspective);
  for (CLI::Option* option : add_ground_options(verb, arguments->ground)) of(option, top | perspective);
  verb->add_option("--ramp", arguments->ramp, "Colours of the heights (default: land)")->check(CLI::IsMember(ramp_names()));
  of(verb->add_option("--width", arguments->width, "Width of the map in pixels at most (default: longest side 2048). Page: samples along the longest side (default: 1280)"), top | profile | page)
      ->check(CLI::Range(16, 20000));
  verb->add_option("--exaggeration", arguments->exaggeration,
                   "Heights for the light, of a profile, in perspective and on a page at first are multiplied by this (default: by the steepness of the terrain; a profile: "
                   "what fills the drawing)")
      ->check(above_zero());
  of(verb->add_option("--azimuth", arguments->azimuth, "Light: 'multi' for four about the north-west (default), or one from so many degrees"), top | perspective | page);
  of(verb->add_flag("--no-legend", arguments->no_legend, "The picture alone"), top | perspective | page);
  of(verb->add_option("--credit", arguments->credit, "Page: whose data it shows, in a line below the scale"), page)->type_name("TEXT");
  of(verb->add_flag("--no-wireframe", arguments->no_wireframe, "The relief of a mesh without the sides of its triangles"), top);
  verb->add_option("--band", arguments->band, "Band, counted from 1 (default: 1)")->check(CLI::PositiveNumber);
  verb->add_flag("--terrain-rgb", arguments->terrain_rgb, "The input is a Mapbox terrain-RGB picture");
}

}  // namespace arete::tools
