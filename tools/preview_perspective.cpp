#include "tools/preview_perspective.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "gis/colour_ramp.h"
#include "gis/geodesy.h"
#include "gis/image.h"
#include "gis/legend.h"
#include "shaders/terrain_renderer.h"
#include "tools/drawn_terrain.h"
#include "tools/elevation_input.h"

namespace arete::tools {
namespace {

struct Place {
  double x, y;
};

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

/// Mixes a colour in where a convex or concave polygon covers the pixel, by 4 x 4 samples.
void fill_polygon(Picture& picture, const std::vector<Place>& corners, Colour colour) {
  double low_x = corners[0].x, high_x = low_x, low_y = corners[0].y, high_y = low_y;
  for (const Place& p : corners) low_x = std::min(low_x, p.x), high_x = std::max(high_x, p.x), low_y = std::min(low_y, p.y), high_y = std::max(high_y, p.y);
  const auto inside = [&](double x, double y) {
    bool odd = false;
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
      if ((corners[i].y > y) != (corners[j].y > y) &&
          x < corners[i].x + (y - corners[i].y) / (corners[j].y - corners[i].y) * (corners[j].x - corners[i].x))
        odd = !odd;
    return odd;
  };
  Picture dot(1, 1, colour);
  for (auto y = static_cast<std::int64_t>(std::floor(low_y)); y <= static_cast<std::int64_t>(high_y); ++y)
    for (auto x = static_cast<std::int64_t>(std::floor(low_x)); x <= static_cast<std::int64_t>(high_x); ++x) {
      int hits = 0;
      for (int s = 0; s < 16; ++s) hits += inside(static_cast<double>(x) + (s % 4 + 0.5) / 4, static_cast<double>(y) + (s / 4 + 0.5) / 4);
      dot(0, 0) = {colour[0], colour[1], colour[2], static_cast<std::uint8_t>(colour[3] * hits / 16)};
      if (hits > 0) paste(picture, dot, x, y);
    }
}

/// A needle that lies flat on the ground in the corner of the picture and points north.
void draw_north(Picture& picture, const Camera& camera) {
  const CameraAxes axes = camera_axes(camera);
  const double radius = std::clamp(static_cast<double>(picture.width()) / 45, 16.0, 60.0);
  const Place centre{static_cast<double>(picture.width()) - 1.9 * radius, static_cast<double>(picture.height()) - 1.9 * radius};
  const auto place = [&](double azimuth_deg, double length) -> Place {
    const Point3 p{std::sin(azimuth_deg * M_PI / 180) * length * radius, std::cos(azimuth_deg * M_PI / 180) * length * radius, 0};
    return {centre.x + dot(p, axes.right), centre.y - dot(p, axes.up)};
  };
  const Colour dark{45, 45, 48, 255}, pale{252, 252, 250, 255};
  fill_polygon(picture, {place(0, 1), place(145, 0.8), place(180, 0.4), place(215, 0.8)}, dark);
  fill_polygon(picture, {place(-1.5, 0.8), place(181.5, 0.37), place(212.5, 0.68)}, pale);
  const Place letter = place(0, 1.45);
  const int size = std::max(12, static_cast<int>(radius * 0.6));
  draw_text(picture, std::llround(letter.x), std::llround(letter.y + 0.35 * size), "N", size, dark, Align::centre);
}

Picture stack(const Picture& above, const Picture& below) {
  Picture sheet(above.width(), above.height() + below.height());
  paste(sheet, above, 0, 0);
  paste(sheet, below, 0, above.height());
  return sheet;
}

Picture add_legend(const Picture& view, const SceneFacts& facts, const GroundStyle& style, const std::string& ramp, const DrapePicture* drape, const std::string& path) {
  Legend legend;
  legend.title = facts.high_m - facts.low_m >= 20 ? fmt::format("Elevation, {:.0f} to {:.0f} m", facts.low_m, facts.high_m)
                                                  : fmt::format("Elevation, {:.2f} to {:.2f} m", facts.low_m, facts.high_m);
  legend.low = facts.ramp_low_m;
  legend.high = facts.ramp_high_m;
  style_legend(legend, style, facts.steepest_deg);
  if (facts.has_water) legend.swatches.push_back({Picture(1, 1, {168, 199, 220, 255}), "water"});
  if (facts.has_voids) legend.swatches.push_back({Picture(1, 1, {95, 94, 96, 255}), "no data"});
  if (facts.exaggeration != 1) legend.note += fmt::format("{}heights exaggerated {:g} times", legend.note.empty() ? "" : "; ", facts.exaggeration);
  if (drape != nullptr) drape_legend(legend, *drape, path);
  Picture sheet = stack(view, draw_legend(legend, ramp_of(style.colour, named_ramp(ramp)), view.width()));
  if (drape != nullptr && drape->values) sheet = stack(sheet, draw_legend(value_legend(*drape, path), named_ramp("viridis"), view.width()));
  return sheet;
}

}  // namespace

std::vector<CLI::Option*> add_perspective_options(CLI::App* verb, PerspectiveArguments& arguments) {
  return {
      verb->add_option("--look-from", arguments.look_from_deg, "Perspective: the camera stands in this direction, degrees clockwise from north (default: 200)")
          ->check(CLI::Range(0.0, 360.0)),
      verb->add_option("--pitch", arguments.pitch_deg, "Perspective: it stands so many degrees above the middle, 90 is from straight above (default: 35)")
          ->check(CLI::Range(1.0, 90.0)),
      verb->add_option("--distance", arguments.distance_m, "Perspective: metres from the middle (default: so that all is seen)")->check(above_zero()),
      verb->add_option("--fov", arguments.field_of_view_deg, "Perspective: vertical field of view in degrees (default: 30)")->check(CLI::Range(1.0, 120.0)),
      verb->add_option("--size", arguments.size, "Perspective: WIDTHxHEIGHT in pixels (default: 1920x1080)"),
      verb->add_option("--style", arguments.mode, "Perspective: lit, wireframe, or levels, a colour for each level of detail (default: lit)")
          ->check(CLI::IsMember({"lit", "wireframe", "levels"})),
      verb->add_option("--pixel-error", arguments.max_error_px, "Perspective: heights are drawn to so many pixels (default: 2)")->check(above_zero()),
  };
}

void draw_perspective(const PerspectiveArguments& arguments, const CommonOptions& common) {
  const Size size = parse_size(arguments.size);
  if (const GroundArguments& ground = arguments.ground; arguments.mode == "levels" && (ground.colour != "height" || !ground.contours.empty() || !ground.drape.empty()))
    throw Error(ErrorKind::usage, "--style levels has colours of its own: leave out --colour, --contours and --drape");
  const ElevationInput input = open_elevations(arguments.input, arguments.dem, common.threads);
  const auto progress = make_progress(common);
  SceneOptions scene = scene_options(arguments.ramp, arguments.exaggeration, arguments.max_error_px, common, 2);
  scene.sun_azimuth_deg = arguments.sun_azimuth_deg;
  scene.supersampling = 2;
  scene.style = ground_style(arguments.ground);
  std::optional<DrapePicture> drape;
  if (!arguments.ground.drape.empty()) {
    drape = drape_of(arguments.ground, arguments.input, input.geo, input.source->size(), common);
    scene.drape = ground_picture(*drape);
    drape->picture = Picture();
  }
  TerrainRenderer renderer(*input.source, cell_size(input.geo, input.source->size()), scene, *progress);
  scene.drape.reset();  // it is on the GPU
  const Camera camera = frame_box(renderer.box(), arguments.look_from_deg, arguments.pitch_deg, arguments.field_of_view_deg,
                                  static_cast<double>(size.width) / static_cast<double>(size.height), arguments.distance_m);
  const Frame frame = renderer.draw(camera, size, mode_of(arguments.mode));

  Picture picture = picture_of(frame);
  if (arguments.legend) {
    draw_north(picture, camera);
    // Levels have colours of their own.
    if (arguments.mode != "levels" && !find_font().empty())
      picture = add_legend(picture, renderer.facts(), renderer.style(), arguments.ramp, drape ? &*drape : nullptr, arguments.ground.drape);
  }
  write_picture(arguments.output, picture, common.overwrite);

  const SceneFacts& facts = renderer.facts();
  print_result(common,
               fmt::format("{}: {} x {} pixels, elevations {:.1f} to {:.1f} m, heights exaggerated {:g} times; {} triangles by {}\n", arguments.output,
                           picture.width(), picture.height(), facts.low_m, facts.high_m, facts.exaggeration, frame.triangles, renderer.driver()),
               {{"picture", arguments.output}, {"width", picture.width()}, {"height", picture.height()}, {"low_m", facts.low_m},
                {"high_m", facts.high_m}, {"contour_interval_m", renderer.style().contour_interval_m},
                {"exaggeration", facts.exaggeration}, {"triangles", frame.triangles}, {"patches", frame.patches},
                {"tiles_loaded", frame.tiles_loaded}, {"camera_m", camera.eye}, {"target_m", camera.target}, {"renderer", renderer.driver()}});
}

}  // namespace arete::tools
