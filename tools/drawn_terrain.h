#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/terrain/ground_style.h"
#include "gis/drape_picture.h"
#include "gis/image.h"
#include "shaders/scene_renderer.h"
#include "tools/command.h"

namespace arete::tools {

/// The options that say how ground is coloured, for what is drawn from above, in perspective and in a window.
struct GroundArguments {
  std::string colour = "height", contours, drape;
};
/// --colour, --contours and --drape, in that order. `arguments` must outlive the parsing.
std::vector<CLI::Option*> add_ground_options(CLI::App* verb, GroundArguments& arguments);
/// Throws Error{usage} where they make no sense.
GroundStyle ground_style(const GroundArguments& arguments);

/// The raster of --drape over a DEM. Throws as read_drape.
DrapePicture drape_of(const GroundArguments& arguments, const std::string& dem, const GeoReference& geo, Size size, const CommonOptions& common);
/// `cell`: of the DEM, metres.
std::shared_ptr<const GroundPicture> ground_picture(const DrapePicture& drape, CellSize cell);

/// A scene in the colours of a ramp (gis/colour_ramp.h), within the verb's memory divided by `share`, on its threads.
SceneOptions scene_options(const std::string& ramp, double exaggeration, double max_error_px, const CommonOptions& common, int share);

/// Says on stderr that legends will be missing, where there is no font.
void warn_without_font(const CommonOptions& common);

Picture picture_of(const Frame& frame);

}  // namespace arete::tools
