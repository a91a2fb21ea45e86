#pragma once

#include <string>

#include "gis/image.h"
#include "shaders/scene_renderer.h"
#include "tools/command.h"

namespace arete::tools {

/// A scene in the colours of a ramp (gis/colour_ramp.h), within the verb's memory divided by `share`, on its threads.
SceneOptions scene_options(const std::string& ramp, double exaggeration, double max_error_px, const CommonOptions& common, int share);

/// Says on stderr that legends will be missing, where there is no font.
void warn_without_font(const CommonOptions& common);

Picture picture_of(const Frame& frame);

}  // namespace arete::tools
