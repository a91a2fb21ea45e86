#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gis/dem_file.h"
#include "tools/command.h"
#include "tools/drawn_terrain.h"
#include "tools/perspective_camera.h"

namespace arete::tools {

/// What `preview --view perspective` takes besides the options of every picture.
struct PerspectiveArguments {
  std::string input, output, ramp = "land";
  double exaggeration = 0;
  double sun_azimuth_deg = 315;
  bool legend = true;
  DemReadOptions dem;
  CameraArguments camera;
  GroundArguments ground;
  std::string size = "1920x1080";
  std::string mode = "lit";
  double max_error_px = 2;
};

/// Adds the options of this view to the verb, and returns them.
std::vector<CLI::Option*> add_perspective_options(CLI::App* verb, PerspectiveArguments& arguments);

/// Draws the picture and prints the result. Throws as open_scene, make_renderer and write_picture do.
void draw_perspective(const PerspectiveArguments& arguments, const CommonOptions& common);

}  // namespace arete::tools
