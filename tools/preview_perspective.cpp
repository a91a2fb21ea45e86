#include "tools/preview_perspective.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gis/colour_ramp.h"
#include "gis/image.h"
#include "gis/legend.h"
#include "gis/staged_files.h"
#include "tools/drawn_terrain.h"
#include "tools/north_needle.h"
#include "tools/scene_input.h"

namespace arete::tools {
namespace {

Size parse_size(const std::string& text) {
  Size size;
  char rest = 0;
  long long width = 0, height = 0;
  if (std::sscanf(text.c_str(), "%lldx%lld%c", &width, &height, &rest) == 2) size = {width, height};
  if (size.width < 64 || size.height < 64 || size.width > 16384 || size.height > 16384)
    throw Error(ErrorKind::usage, "--size takes WIDTHxHEIGHT in pixels, 64x64 to 16384x16384, not '" + text + "'");
  return size;
}

DrawMode mode_of(const std::string& name) { return name == "wireframe" ? DrawMode::wireframe : name == "levels" ? DrawMode::levels : DrawMode::lit; }

/// The strip under the picture. `drape` may be null.
Picture legend_of(const SceneFacts& facts, const GroundStyle& style, const std::string& ramp, const DrapePicture* drape, const std::string& drape_path,
                  std::int64_t width, double metres_per_pixel) {
  Legend legend;
  legend.title = facts.high_m - facts.low_m >= 20 ? fmt::format("Elevation, {:.0f} to {:.0f} m", facts.low_m, facts.high_m)
                                                  : fmt::format("Elevation, {:.2f} to {:.2f} m", facts.low_m, facts.high_m);
  legend.low = facts.ramp_low_m;
  legend.high = facts.ramp_high_m;
  legend.metres_per_pixel = metres_per_pixel;
  legend.scale_note = "across, in the middle";
  style_legend(legend, style, facts.steepest_deg);
  if (facts.has_water) legend.swatches.push_back({Picture(1, 1, {168, 199, 220, 255}), "water"});
  if (facts.has_voids) legend.swatches.push_back({Picture(1, 1, {95, 94, 96, 255}), "no data"});
  if (facts.exaggeration != 1) legend.note += fmt::format("{}heights exaggerated {:g} times", legend.note.empty() ? "" : "; ", facts.exaggeration);
  if (drape != nullptr) drape_legend(legend, *drape, drape_path);
  const Picture strip = draw_legend(legend, ramp_of(style.colour, named_ramp(ramp)), width);
  return drape != nullptr && drape->values ? stack(strip, draw_legend(value_legend(*drape, drape_path), named_ramp("viridis"), width)) : strip;
}

/// How the pictures of one call are drawn.
struct Drawing {
  Size view;
  DrawMode mode = DrawMode::lit;
  PictureDepth depth = PictureDepth::bits8;
  bool needle = false;
  double grid_north_deg = 0;
  Picture legend = {};  ///< under the view; may be empty
  int threads = 0;
};

std::span<const std::uint8_t> bytes_of(const Picture& picture) {
  return {picture.data()->data(), static_cast<std::size_t>(4 * picture.width() * picture.height())};
}

/// Develops rows for the eye, draws the needle over them, and writes them.
void write_rows(const LightRows& rows, const Camera& camera, const Drawing& drawing, PictureFile& file) {
  if (drawing.depth == PictureDepth::half) return file.write(rows.rgba);
  Picture picture(rows.size.width, rows.size.height);
  develop(rows, drawing.threads, picture.data()->data());
  const auto draw_over = [&] {
    if (drawing.needle) draw_north(picture, rows.y, drawing.view.height, camera, drawing.grid_north_deg);
  };
  if (drawing.depth == PictureDepth::bits8) {
    draw_over();
    return file.write(bytes_of(picture));
  }
  std::vector<std::uint16_t> fine(rows.rgba.size());
  develop(rows, drawing.threads, fine.data());
  const Picture before = picture;
  draw_over();
  // What is drawn over them has 8 bits.
  for (std::size_t i = 0; i < fine.size(); ++i)
    if (bytes_of(picture)[i] != bytes_of(before)[i]) fine[i] = static_cast<std::uint16_t>(257 * bytes_of(picture)[i]);
  file.write(fine);
}

Frame draw_picture(SceneRenderer& renderer, const Camera& camera, const Drawing& drawing, const std::string& path, bool overwrite, Progress& progress) {
  PictureFile file(path, {drawing.view.width, drawing.view.height + drawing.legend.height()}, drawing.depth, overwrite);
  const Highlights highlights = drawing.depth == PictureDepth::half ? Highlights::kept : Highlights::roll_off;
  const Frame frame = renderer.draw_rows(camera, drawing.view, drawing.mode, highlights, [&](const LightRows& rows) {
    write_rows(rows, camera, drawing, file);
    progress.advance(rows.size.height);
  });
  if (drawing.legend.height() > 0) file.write(bytes_of(drawing.legend));
  file.publish();
  return frame;
}

/// OUT, or OUT-000 and so on before its extension.
std::vector<std::string> picture_paths(const std::string& output, int turntable) {
  if (turntable == 0) return {output};
  const std::filesystem::path path(output);
  const std::size_t digits = std::max<std::size_t>(3, std::to_string(turntable - 1).size());
  std::vector<std::string> paths;
  for (int i = 0; i < turntable; ++i)
    paths.push_back((path.parent_path() / fmt::format("{}-{:0{}}{}", path.stem().string(), i, digits, path.extension().string())).string());
  return paths;
}

/// Draws into files that appear together. The frame counts what all of them took.
Frame draw_pictures(SceneRenderer& renderer, const std::vector<Camera>& cameras, const Drawing& drawing, const std::vector<std::string>& paths, bool overwrite,
                    Progress& progress) {
  progress.begin(cameras.size() > 1 ? "drawing pictures" : "drawing", static_cast<std::int64_t>(cameras.size()) * drawing.view.height);
  Frame sum{drawing.view, {}, 0, 0, 0};
  const auto draw_one = [&](std::size_t i, const std::string& path, bool replace) {
    const Frame frame = draw_picture(renderer, cameras[i], drawing, path, replace, progress);
    sum.patches += frame.patches, sum.triangles += frame.triangles, sum.tiles_loaded += frame.tiles_loaded;
  };
  if (cameras.size() == 1) {
    draw_one(0, paths[0], overwrite);
  } else {
    StagedFiles files(paths.back(), overwrite);
    for (std::size_t i = 0; i < cameras.size(); ++i)
      draw_one(i, std::filesystem::path(files.staged()).replace_filename(std::filesystem::path(paths[i]).filename()).string(), false);
    files.publish();
  }
  progress.end();
  return sum;
}

/// The ground of a mesh in the cells of its input, as its renderer knows it once there is one.
class DrawnGround final : public RasterSource {
 public:
  DrawnGround(const std::unique_ptr<SceneRenderer>& renderer, const SceneInput& input) : renderer_(renderer), size_(input.size), cell_(input.cell) {}
  Size size() const override { return size_; }
  void read(const Window& window, RasterView<float> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) {
        const double height = renderer_->ground_height(static_cast<double>(window.x + x) * cell_.x_m, -static_cast<double>(window.y + y) * cell_.y_m);
        out(x, y) = static_cast<float>(height / renderer_->facts().exaggeration);
      }
  }

 private:
  const std::unique_ptr<SceneRenderer>& renderer_;
  Size size_;
  CellSize cell_;
};

}  // namespace

std::vector<CLI::Option*> add_perspective_options(CLI::App* verb, PerspectiveArguments& arguments) {
  return {
      verb->add_option("--look-from", arguments.camera.look_from_deg, "Perspective: the camera stands in this direction, degrees clockwise from north (default: 200)")
          ->check(CLI::Range(0.0, 360.0)),
      verb->add_option("--pitch", arguments.camera.pitch_deg, "Perspective: it stands so many degrees above the middle, 90 is from straight above (default: 35)")
          ->check(CLI::Range(1.0, 90.0)),
      verb->add_option("--distance", arguments.camera.distance_m, "Perspective: metres from the middle, or from --look-at (default: so that all is seen)")->check(above_zero()),
      verb->add_option("--look-at", arguments.camera.look_at,
                       "Perspective: the place in the middle of the picture, in the CRS of the DEM (degrees where that is geographic); Z in metres above its zero, not "
                       "exaggerated (default: the ground there)")
          ->type_name("X,Y[,Z]"),
      verb->add_option("--eye", arguments.camera.eye,
                       "Perspective: the camera stands here, likewise, or with X,Y,+H H metres above the ground, and looks at --look-at, or the middle of the terrain; in "
                       "place of --look-from, --pitch and --distance")
          ->type_name("X,Y,Z"),
      verb->add_option("--turntable", arguments.camera.turntable,
                       "Perspective: so many pictures, OUT-000 and so on, from all round, clockwise from --look-from on; all appear when the last is drawn")
          ->check(CLI::Range(2, 10000)),
      verb->add_option("--fov", arguments.camera.field_of_view_deg, "Perspective: vertical field of view in degrees (default: 30)")->check(CLI::Range(1.0, 120.0)),
      verb->add_option("--size", arguments.size, "Perspective: WIDTHxHEIGHT in pixels (default: 1920x1080)"),
      verb->add_option("--style", arguments.mode, "Perspective: lit, wireframe, or of a DEM levels, a colour for each level of detail (default: lit)")
          ->check(CLI::IsMember({"lit", "wireframe", "levels"})),
      verb->add_option("--pixel-error", arguments.max_error_px, "Perspective: heights of a DEM are drawn to so many pixels (default: 2)")->check(above_zero()),
  };
}

void draw_perspective(const PerspectiveArguments& arguments, const CommonOptions& common) {
  Drawing drawing{.view = parse_size(arguments.size), .mode = mode_of(arguments.mode), .depth = depth_of(arguments.output), .threads = common.threads};
  check_camera(arguments.camera);
  if (const GroundArguments& given = arguments.ground; arguments.mode == "levels" && (given.colour != "height" || !given.contours.empty() || !given.drape.empty()))
    throw Error(ErrorKind::usage, "--style levels has colours of its own: leave out --colour, --contours and --drape");
  const GroundStyle style = ground_style(arguments.ground);
  const std::vector<std::string> paths = picture_paths(arguments.output, arguments.camera.turntable);
  for (const std::string& path : paths) check_picture_path(path, common.overwrite);
  const bool legend = arguments.legend && drawing.depth != PictureDepth::half;
  if (legend) warn_without_font(common);

  SceneInput input = open_scene(arguments.input, arguments.dem, common);
  if (input.is_mesh() && arguments.mode == "levels")
    throw Error(ErrorKind::usage, "--style levels is of DEMs and trees (.sct), which are drawn in levels of detail: '" + arguments.input + "' is a mesh");
  std::unique_ptr<SceneRenderer> scene_renderer;
  const DrawnGround mesh_ground(scene_renderer, input);
  const CameraGround ground{input.is_mesh() ? static_cast<const RasterSource&>(mesh_ground) : *input.dem.source, input.geo, input.cell};
  CameraPlaces places;
  if (!input.is_mesh()) places = find_places(arguments.camera, ground);
  const auto progress = make_progress(common);
  SceneOptions scene = scene_options(arguments.ramp, arguments.exaggeration, arguments.max_error_px, common, 3);
  scene.sun_azimuth_deg = arguments.sun_azimuth_deg + grid_north_deg(ground);
  scene.supersampling = 2;
  scene.style = style;
  std::optional<DrapePicture> drape;
  if (!arguments.ground.drape.empty()) {
    drape = drape_of(arguments.ground, arguments.input, input.geo, input.size, common);
    scene.drape = ground_picture(*drape, input.cell);
    drape->picture = Picture();
  }
  scene_renderer = make_renderer(input, input, scene, *progress);
  scene.drape.reset();  // it is on the GPU
  SceneRenderer& renderer = *scene_renderer;
  if (input.is_mesh()) places = find_places(arguments.camera, ground);
  const SceneFacts& facts = renderer.facts();
  const double aspect = static_cast<double>(drawing.view.width) / static_cast<double>(drawing.view.height);
  const std::vector<Camera> cameras = place_cameras(arguments.camera, places, ground, renderer.box(), facts.exaggeration, aspect);
  const Camera& camera = cameras.front();
  const double pixel_m = metres_per_pixel(camera, drawing.view.height);
  drawing.needle = legend;
  drawing.grid_north_deg = grid_north_deg(ground);
  // Levels have colours of their own.
  if (legend && arguments.mode != "levels" && !find_font().empty())
    drawing.legend = legend_of(facts, renderer.style(), arguments.ramp, drape ? &*drape : nullptr, arguments.ground.drape, drawing.view.width, pixel_m);
  const Frame frame = draw_pictures(renderer, cameras, drawing, paths, common.overwrite, *progress);

  const std::int64_t height = drawing.view.height + drawing.legend.height();
  const bool many = paths.size() > 1;
  nlohmann::json data = {{"width", drawing.view.width}, {"height", height}, {"low_m", facts.low_m}, {"high_m", facts.high_m},
                         {"contour_interval_m", renderer.style().contour_interval_m}, {"exaggeration", facts.exaggeration},
                         {"triangles", frame.triangles}, {"patches", frame.patches},
                         {"tiles_loaded", frame.tiles_loaded}, {"camera_m", camera.eye}, {"target_m", camera.target},
                         {"eye", place_in_crs(camera.eye, ground, facts.exaggeration)}, {"look_at", place_in_crs(camera.target, ground, facts.exaggeration)},
                         {"metres_per_pixel", pixel_m}, {"renderer", renderer.driver()}};
  many ? data["pictures"] = paths : data["picture"] = paths.front();
  print_result(common,
               fmt::format("{}: {}{} x {} pixels, elevations {:.1f} to {:.1f} m, heights exaggerated {:g} times; {} triangles by {}\n",
                           many ? paths.front() + " to " + paths.back() : paths.front(), many ? fmt::format("{} pictures of ", paths.size()) : "", drawing.view.width, height,
                           facts.low_m, facts.high_m, facts.exaggeration, frame.triangles, renderer.driver()),
               data);
}

}  // namespace arete::tools
