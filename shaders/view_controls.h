#pragma once

#include <functional>

#include "core/terrain/ground_style.h"
#include "shaders/camera.h"

namespace arete {

/// Where the eye may go. Heights are exaggerated metres.
struct ViewGround {
  Box box;
  std::function<double(double x, double y)> height;  ///< of the ground, anywhere: outside the terrain that of its border
};

/// A camera as hands move it: it looks at `target` from a compass direction, `pitch_deg` above it. Below 0 it looks up.
struct ViewCamera {
  Point3 target = {0, 0, 0};
  double azimuth_deg = 200;  ///< of the eye, seen from the target; [0, 360)
  double pitch_deg = 35;     ///< 1 to 89.9 in orbit, -80 to 89.9 in flight
  double distance_m = 1;
  double field_of_view_deg = 30;
};
Camera camera_of(const ViewCamera& view);

/// Shows the whole terrain.
ViewCamera whole_view(const ViewGround& ground, double azimuth_deg, double pitch_deg, double field_of_view_deg, double aspect);

/// A place in the window: pixels from its upper left corner, with its size.
struct WindowPlace {
  double x = 0, y = 0, width = 1, height = 1;
};

/// Turns round the target: the terrain follows the hand. The window's height is 180 degrees.
void orbit(ViewCamera& view, double dx, double dy, double window_height, const ViewGround& ground);
/// Moves target and eye over the ground so that the target follows the hand.
void pan(ViewCamera& view, double dx, double dy, double window_height, const ViewGround& ground);
/// Comes closer (steps > 0) by a fifth per step to the ground under the cursor, which stays under it; to the target where the cursor is in the
/// sky. From 10^-4 to 10 times the diagonal of the terrain away.
void zoom(ViewCamera& view, const WindowPlace& cursor, double steps, const ViewGround& ground);
/// Looks round from where the eye is: what is seen follows the hand.
void look(ViewCamera& view, double dx, double dy, double window_height);
/// Flies so many metres ahead, to the right and up; ahead is where the camera looks.
void fly(ViewCamera& view, double ahead, double right, double up, const ViewGround& ground);
/// Metres per second: a share of the height above the ground, so that all heights are equally easy.
double flight_speed(const ViewCamera& view, const ViewGround& ground);
/// The same place after heights were exaggerated `ratio` times more.
void stretch(ViewCamera& view, double ratio);

/// The first point of the ground on the ray through a place of the window; false in the sky. Steps of 1/512 of the diagonal, then bisection.
bool pick_ground(const ViewCamera& view, const WindowPlace& at, const ViewGround& ground, Point3& point);

/// The sun, as hands move it: azimuth [0, 360) and elevation [2, 89] degrees.
struct ViewSun {
  double azimuth_deg = 315, elevation_deg = 40;
};
void turn_sun(ViewSun& sun, double azimuth_deg, double elevation_deg);

/// What colours tell next: heights, slopes, aspects, heights.
GroundColour next_colour(GroundColour colour);

/// How two terrains share the window.
enum class ViewLayout { side_by_side, swipe, first, second };
ViewLayout next_layout(ViewLayout layout);
/// A divider (share of the width) kept where it can be seen: 0.02 to 0.98.
double clamp_divider(double share);

}  // namespace arete
