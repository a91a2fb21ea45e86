#include "tools/drawn_terrain.h"

#include <cstring>

#include "gis/colour_ramp.h"

namespace arete::tools {

SceneOptions scene_options(const std::string& ramp, double exaggeration, double max_error_px, const CommonOptions& common, int share) {
  SceneOptions options;
  options.exaggeration = exaggeration;
  options.threads = common.threads;
  options.memory_bytes = common.memory_bytes / share;
  options.detail.max_error_px = max_error_px;
  const ColourRamp colours = named_ramp(ramp);
  for (int i = 0; i < 1024; ++i) {
    const Colour colour = colours.at(i / 1023.0);
    options.ramp.push_back({colour[0], colour[1], colour[2]});
  }
  return options;
}

void warn_without_font(const CommonOptions& common) {
  if (find_font().empty()) warn(common, "no font found, the legend is left out: install fonts-dejavu-core or set ARETE_FONT");
}

Picture picture_of(const Frame& frame) {
  Picture picture(frame.size.width, frame.size.height);
  std::memcpy(picture.data(), frame.rgba.data(), frame.rgba.size());
  return picture;
}

}  // namespace arete::tools
