#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "shaders/view_picture.h"

namespace arete {

struct WindowOptions {
  std::string title;                   ///< followed by what the picture took, when asked for
  Size size = {1280, 800};             ///< at first, in the units of the desktop
  double look_from_deg = 200, pitch_deg = 35, field_of_view_deg = 30;
  ViewSun sun;
  double close_after_s = 0;            ///< > 0: closes by itself after so long
  std::function<void(const Frame&)> save;            ///< takes a picture of the window; what it throws ends the window
  std::function<void(const std::string&)> say;       ///< takes text for the user: the keys
};

/// What was drawn until the window was closed.
struct WindowReport {
  std::int64_t frames = 0, pictures = 0;
};

/// The keys and what they do, one a line.
std::string window_keys();

/// Throws Error{input} where no window can be opened: no display. Call it before long work.
void require_display();

/// Shows terrains in a window until it is closed. Draws when something changed; while it moves, with fewer pixels where a picture takes
/// long. One thread. Throws Error{input} where the window cannot be opened.
WindowReport run_terrain_window(const ViewedTerrains& terrains, const WindowOptions& options);

}  // namespace arete
