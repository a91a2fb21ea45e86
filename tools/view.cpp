#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "gis/colour_ramp.h"
#include "gis/image.h"
#include "shaders/terrain_window.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/drawn_terrain.h"
#include "tools/scene_input.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct ViewArguments {
  std::string input, other, ramp = "land";
  DemReadOptions dem;
  GroundArguments ground;
  double exaggeration = 0, look_from_deg = 200, pitch_deg = 35, field_of_view_deg = 30, max_error_px = 2, close_after_s = 0;
};

/// The first name IN-view-N.png of the working folder that is free.
std::string free_name(const std::string& input) {
  const std::string stem = std::filesystem::path(input).stem().string();
  for (int n = 1;; ++n) {
    const std::string name = fmt::format("{}-view-{}.png", stem, n);
    if (!std::filesystem::exists(name)) return name;
  }
}

void save_picture(const Frame& frame, const std::string& input, const CommonOptions& common) {
  // A disk that is full is no reason to close the window.
  try {
    const std::string name = free_name(input);
    write_picture(name, picture_of(frame));
    if (!common.quiet) std::fprintf(stderr, "%s\n", name.c_str());
  } catch (const Error& error) {
    std::fprintf(stderr, "arete view: %s\n", error.what());
  }
}

void run_view(const ViewArguments& arguments, const CommonOptions& common) {
  limit_block_cache(common.memory_bytes / 4);
  const GroundStyle style = ground_style(arguments.ground);
  require_display();
  SceneInput input = open_scene(arguments.input, arguments.dem, common), other;
  ViewedTerrains terrains;
  if (!arguments.other.empty()) {
    other = open_scene(arguments.other, arguments.dem, common);
    terrains.offset_m = offset_between(input, other);
  }
  SceneOptions options = scene_options(arguments.ramp, arguments.exaggeration, arguments.max_error_px, common, arguments.other.empty() ? 3 : 6);
  options.style = style;
  std::unique_ptr<SceneRenderer> first, second;
  {
    const auto progress = make_progress(common);
    const auto lay_over = [&](const SceneInput& scene, CellSize cell) {
      if (!arguments.ground.drape.empty()) options.drape = ground_picture(drape_of(arguments.ground, scene.path, scene.geo, scene.size, common), cell);
    };
    lay_over(input, input.cell);
    first = make_renderer(input, input, options, *progress);
    if (!arguments.other.empty()) {
      // The same height, or slope, has the same colour in both.
      options.steepest_deg = first->facts().steepest_deg;
      options.ramp_range_m = {first->facts().ramp_low_m, first->facts().ramp_high_m};
      options.exaggeration = first->facts().exaggeration;
      // A mesh is placed in the cells of the first.
      if (other.is_mesh()) lay_over(input, input.cell);
      else lay_over(other, other.cell);
      second = make_renderer(other, input, options, *progress);
    }
  }
  options.drape.reset();  // it is on the GPU
  terrains.first = first.get();
  terrains.second = second.get();

  WindowOptions window;
  window.title = "arete view " + arguments.input + (arguments.other.empty() ? "" : " | " + arguments.other);
  window.look_from_deg = arguments.look_from_deg;
  window.pitch_deg = arguments.pitch_deg;
  window.field_of_view_deg = arguments.field_of_view_deg;
  window.close_after_s = arguments.close_after_s;
  window.save = [&](const Frame& frame) { save_picture(frame, arguments.input, common); };
  window.say = [](const std::string& text) { std::fputs(text.c_str(), stderr); };
  if (!common.quiet) std::fputs("arete view: H prints the keys\n", stderr);
  const WindowReport report = run_terrain_window(terrains, window);
  print_result(common, fmt::format("{} pictures drawn, {} saved, by {}\n", report.frames, report.pictures, first->driver()),
               {{"frames", report.frames}, {"pictures", report.pictures}, {"renderer", first->driver()}});
}

}  // namespace

void add_view(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* verb = add_verb(app, "view", "Show a DEM or a mesh, or two of the same ground, in a window: turn, zoom, fly, swipe",
                            "arete view dem.tif\narete view truth.tif finer.tif\narete view dem.tif mesh.ply", common, [arguments, common] { run_view(*arguments, *common); });
  verb->add_option("IN", arguments->input, "The DEM, tree (.sct) or mesh (.ply...); H in the window prints its keys")->required();
  verb->add_option("OTHER", arguments->other, "Another of the same ground, DEM or mesh: drag the divider, Tab changes how both are shown");
  verb->add_option("--ramp", arguments->ramp, "Colours of the heights (default: land)")->check(CLI::IsMember(ramp_names()));
  add_ground_options(verb, arguments->ground);
  verb->add_option("--exaggeration", arguments->exaggeration, "Heights are multiplied by this at first (default: by the steepness of the terrain)")
      ->check(above_zero());
  verb->add_option("--look-from", arguments->look_from_deg, "The camera stands in this direction at first, degrees clockwise from north (default: 200)")
      ->check(CLI::Range(0.0, 360.0));
  verb->add_option("--pitch", arguments->pitch_deg, "It stands so many degrees above the middle at first (default: 35)")->check(CLI::Range(1.0, 90.0));
  verb->add_option("--fov", arguments->field_of_view_deg, "Vertical field of view in degrees (default: 30)")->check(CLI::Range(1.0, 120.0));
  verb->add_option("--pixel-error", arguments->max_error_px, "Heights are drawn to so many pixels (default: 2)")->check(above_zero());
  verb->add_option("--close-after", arguments->close_after_s, "Close the window after so many seconds, for demonstrations and tests (default: never)")
      ->check(above_zero());
  add_dem_options(verb, arguments->dem);
}

}  // namespace arete::tools
