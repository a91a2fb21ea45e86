#include "shaders/view_controls.h"

#include <algorithm>
#include <cmath>

namespace arete {
namespace {

constexpr double radians = M_PI / 180;
// Straight down has no azimuth.
constexpr double steepest_deg = 89.9;

double diagonal(const Box& box) {
  const Point3 span = subtract(box.high, box.low);
  return std::sqrt(dot(span, span));
}

double turned(double degrees) {
  const double rest = std::fmod(degrees, 360);
  return rest < 0 ? rest + 360 : rest;
}

Point3 along(const Point3& from, const Point3& direction, double length) {
  return {from[0] + direction[0] * length, from[1] + direction[1] * length, from[2] + direction[2] * length};
}

double clearance(const ViewGround& ground) { return 1e-3 * diagonal(ground.box); }

/// Lifts the view where the eye is in the ground, or less than the clearance above it. Walls and what lies around have no height.
void stay_above(ViewCamera& view, const ViewGround& ground) {
  const Point3 eye = camera_of(view).eye;
  const bool over = eye[0] >= ground.box.low[0] && eye[0] <= ground.box.high[0] && eye[1] >= ground.box.low[1] && eye[1] <= ground.box.high[1];
  const double lowest = over ? ground.height(eye[0], eye[1]) + clearance(ground) : ground.box.low[2];
  if (eye[2] < lowest) view.target[2] += lowest - eye[2];
}

/// Keeps the middle of the view on the terrain.
void stay_on(ViewCamera& view, const ViewGround& ground) {
  for (std::size_t c = 0; c < 2; ++c) view.target[c] = std::clamp(view.target[c], ground.box.low[c], ground.box.high[c]);
}

Point3 ray_through(const Camera& camera, const WindowPlace& at) {
  const CameraAxes axes = camera_axes(camera);
  const double half = std::tan(camera.field_of_view_deg * radians / 2);
  const double x = (2 * at.x / at.width - 1) * half * at.width / at.height, y = (1 - 2 * at.y / at.height) * half;
  return along(along(axes.ahead, axes.right, x), axes.up, y);
}

}  // namespace

Camera camera_of(const ViewCamera& view) {
  return orbit_camera(view.target, view.azimuth_deg, view.pitch_deg, view.distance_m, view.field_of_view_deg);
}

ViewCamera whole_view(const ViewGround& ground, double azimuth_deg, double pitch_deg, double field_of_view_deg, double aspect) {
  ViewCamera view{{}, turned(azimuth_deg), std::min(pitch_deg, steepest_deg), 1, field_of_view_deg};
  const Camera camera = frame_box(ground.box, view.azimuth_deg, view.pitch_deg, field_of_view_deg, aspect);
  const Point3 back = subtract(camera.eye, camera.target);
  view.target = camera.target;
  view.distance_m = std::sqrt(dot(back, back));
  return view;
}

void orbit(ViewCamera& view, double dx, double dy, double window_height, const ViewGround& ground) {
  view.azimuth_deg = turned(view.azimuth_deg + 180 * dx / window_height);
  view.pitch_deg = std::clamp(view.pitch_deg + 180 * dy / window_height, 1.0, steepest_deg);
  stay_above(view, ground);
}

void pan(ViewCamera& view, double dx, double dy, double window_height, const ViewGround& ground) {
  const double metres = 2 * view.distance_m * std::tan(view.field_of_view_deg * radians / 2) / window_height;
  const double azimuth = view.azimuth_deg * radians;
  // Ahead over level ground; one pixel upwards is farther there the flatter the view is.
  const Point3 ahead{-std::sin(azimuth), -std::cos(azimuth), 0}, right{-std::cos(azimuth), std::sin(azimuth), 0};
  const double flat = std::max(std::sin(std::abs(view.pitch_deg) * radians), 0.2);
  view.target = along(along(view.target, right, -dx * metres), ahead, dy * metres / flat);
  stay_on(view, ground);
  stay_above(view, ground);
}

bool pick_ground(const ViewCamera& view, const WindowPlace& at, const ViewGround& ground, Point3& point) {
  const Camera camera = camera_of(view);
  Point3 direction = ray_through(camera, at);
  const double length = std::sqrt(dot(direction, direction));
  for (double& d : direction) d /= length;
  // The part of the ray inside the box, which may end at the ground.
  double from = 0, to = INFINITY;
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(direction[c]) < 1e-12) {
      if (camera.eye[c] < ground.box.low[c] || camera.eye[c] > ground.box.high[c]) return false;
      continue;
    }
    const double a = (ground.box.low[c] - camera.eye[c]) / direction[c], b = (ground.box.high[c] - camera.eye[c]) / direction[c];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (!(from < to)) return false;
  const auto above = [&](double t) {
    const Point3 p = along(camera.eye, direction, t);
    return p[2] - ground.height(p[0], p[1]) > 0;
  };
  constexpr int steps = 512;
  double clear = from, hit = -1;
  if (!above(from)) hit = from;  // a wall
  for (int i = 1; i <= steps && hit < 0; ++i) {
    const double t = from + (to - from) * i / steps;
    if (above(t)) clear = t;
    else hit = t;
  }
  if (hit < 0) return false;
  for (int i = 0; i < 30; ++i) {
    const double middle = (clear + hit) / 2;
    (above(middle) ? clear : hit) = middle;
  }
  point = along(camera.eye, direction, hit);
  return true;
}

void zoom(ViewCamera& view, const WindowPlace& cursor, double steps, const ViewGround& ground) {
  Point3 towards = view.target;
  pick_ground(view, cursor, ground, towards);
  const double size = diagonal(ground.box);
  const double distance = std::clamp(view.distance_m * std::pow(0.8, steps), 1e-4 * size, 10 * size), share = distance / view.distance_m;
  // Eye and target shrink towards the point, so that it stays where it is in the window.
  view.target = along(towards, subtract(view.target, towards), share);
  view.distance_m = distance;
  stay_above(view, ground);
}

void look(ViewCamera& view, double dx, double dy, double window_height) {
  const Point3 eye = camera_of(view).eye;
  const double degrees = view.field_of_view_deg / window_height;
  view.azimuth_deg = turned(view.azimuth_deg - degrees * dx);
  view.pitch_deg = std::clamp(view.pitch_deg - degrees * dy, -80.0, steepest_deg);
  view.target = along(eye, camera_axes(camera_of(view)).ahead, view.distance_m);
}

double flight_speed(const ViewCamera& view, const ViewGround& ground) {
  const Point3 eye = camera_of(view).eye;
  return std::max(eye[2] - ground.height(eye[0], eye[1]), 4 * clearance(ground));
}

void fly(ViewCamera& view, double ahead, double right, double up, const ViewGround& ground) {
  const CameraAxes axes = camera_axes(camera_of(view));
  view.target = along(along(view.target, axes.ahead, ahead), axes.right, right);
  view.target[2] += up;
  // Not so far away that the terrain is lost.
  const Point3 eye = camera_of(view).eye;
  const double reach = 2 * diagonal(ground.box);
  for (std::size_t c = 0; c < 3; ++c) view.target[c] += std::clamp(eye[c], ground.box.low[c] - reach, ground.box.high[c] + reach) - eye[c];
  stay_above(view, ground);
}

void stretch(ViewCamera& view, double ratio) { view.target[2] *= ratio; }

void turn_sun(ViewSun& sun, double azimuth_deg, double elevation_deg) {
  sun.azimuth_deg = turned(sun.azimuth_deg + azimuth_deg);
  sun.elevation_deg = std::clamp(sun.elevation_deg + elevation_deg, 2.0, 89.0);
}

GroundColour next_colour(GroundColour colour) {
  switch (colour) {
    case GroundColour::height: return GroundColour::slope;
    case GroundColour::slope: return GroundColour::aspect;
    case GroundColour::aspect: break;
  }
  return GroundColour::height;
}

ViewLayout next_layout(ViewLayout layout) {
  switch (layout) {
    case ViewLayout::side_by_side: return ViewLayout::swipe;
    case ViewLayout::swipe: return ViewLayout::first;
    case ViewLayout::first: return ViewLayout::second;
    case ViewLayout::second: break;
  }
  return ViewLayout::side_by_side;
}

double clamp_divider(double share) { return std::clamp(share, 0.02, 0.98); }

}  // namespace arete
