#include "tools/drawn_terrain.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/support/error.h"
#include "gis/colour_ramp.h"

namespace arete::tools {
namespace {

std::vector<std::array<std::uint8_t, 3>> table_of(const ColourRamp& ramp) {
  std::vector<std::array<std::uint8_t, 3>> table;
  for (int i = 0; i < 1024; ++i) {
    const Colour colour = ramp.at(i / 1023.0);
    table.push_back({colour[0], colour[1], colour[2]});
  }
  return table;
}

}  // namespace

std::vector<CLI::Option*> add_ground_options(CLI::App* verb, GroundArguments& arguments) {
  return {
      verb->add_option("--colour,--color", arguments.colour, "What colours tell: height (default), slope in degrees, or aspect, the direction that the ground faces")
          ->check(CLI::IsMember({"height", "slope", "aspect"})),
      verb->add_option("--contours", arguments.contours, "Draw contours, so many metres apart; alone or with 'auto' at a round interval that suits the relief")
          ->type_name("METRES")
          ->expected(0, 1)
          ->default_str("auto"),
      verb->add_option("--drape", arguments.drape, "Lay an orthophoto or another raster over the ground, warped from its own CRS; where it has no data the ground shows")
          ->type_name("RASTER"),
  };
}

GroundStyle ground_style(const GroundArguments& arguments) {
  GroundStyle style;
  style.colour = arguments.colour == "slope" ? GroundColour::slope : arguments.colour == "aspect" ? GroundColour::aspect : GroundColour::height;
  if (arguments.contours.empty()) return style;
  style.contour_interval_m = suitable_interval;
  if (arguments.contours == "auto") return style;
  char* end = nullptr;
  style.contour_interval_m = std::strtod(arguments.contours.c_str(), &end);
  if (*end != 0 || !(style.contour_interval_m >= 1e-3 && style.contour_interval_m <= 1e4))
    throw Error(ErrorKind::usage, "--contours takes 'auto' or metres from 0.001 to 10000, not '" + arguments.contours + "'");
  return style;
}

SceneOptions scene_options(const std::string& ramp, double exaggeration, double max_error_px, const CommonOptions& common, int share) {
  SceneOptions options;
  options.exaggeration = exaggeration;
  options.threads = common.threads;
  options.memory_bytes = common.memory_bytes / share;
  options.detail.max_error_px = max_error_px;
  options.ramp = table_of(named_ramp(ramp));
  options.slope_ramp = table_of(slope_ramp());
  options.aspect_ramp = table_of(aspect_ramp());
  const Colour flat = flat_colour();
  options.flat_colour = {flat[0], flat[1], flat[2]};
  return options;
}

void warn_without_font(const CommonOptions& common) {
  if (find_font().empty()) warn(common, "no font found, the legend is left out: install fonts-dejavu-core or set ARETE_FONT");
}

DrapePicture drape_of(const GroundArguments& arguments, const std::string& dem, const GeoReference& geo, Size size, const CommonOptions& common) {
  // Its pixels, and those of the atlas here and on the GPU, half as many again each: 16 bytes a pixel.
  const auto longest = static_cast<std::int64_t>(std::sqrt(static_cast<double>(common.memory_bytes) / 16));
  return read_drape(arguments.drape, {dem, geo, size}, {.longest = std::clamp<std::int64_t>(longest, 256, 8192)});
}

std::shared_ptr<const GroundPicture> ground_picture(const DrapePicture& drape, CellSize cell) {
  const auto picture = std::make_shared<GroundPicture>();
  picture->size = {drape.picture.width(), drape.picture.height()};
  picture->rgba.assign(drape.picture.data(), drape.picture.data() + picture->size.cells());
  picture->cell = cell;
  picture->left = drape.left, picture->top = drape.top, picture->width = drape.width, picture->height = drape.height;
  return picture;
}

Picture picture_of(const Frame& frame) {
  Picture picture(frame.size.width, frame.size.height);
  std::memcpy(picture.data(), frame.rgba.data(), frame.rgba.size());
  return picture;
}

}  // namespace arete::tools
