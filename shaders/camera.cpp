#include "shaders/camera.h"

#include <algorithm>
#include <cmath>

namespace arete {
namespace {

Point3 scaled(const Point3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
Point3 sum(const Point3& a, const Point3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point3 unit(const Point3& a) { return scaled(a, 1 / std::sqrt(dot(a, a))); }

Point3 corner(const Box& box, int i) {
  return {i & 1 ? box.high[0] : box.low[0], i & 2 ? box.high[1] : box.low[1], i & 4 ? box.high[2] : box.low[2]};
}

/// Share of the picture that a framed box takes.
constexpr double margin = 0.96;

/// Half the picture plane at distance 1.
struct HalfPlane {
  double width, height;
};
HalfPlane half_plane(const Camera& camera, double aspect) {
  const double height = std::tan(camera.field_of_view_deg * M_PI / 360);
  return {height * aspect, height};
}

/// The part's middle and half size in units of the half picture plane: x to the right, y up.
struct PartOf {
  double x, y, width, height;
};
PartOf part_of(Size picture, const PicturePart& part) {
  const auto w = static_cast<double>(picture.width), h = static_cast<double>(picture.height);
  const auto pw = static_cast<double>(part.width), ph = static_cast<double>(part.height);
  return {(2 * static_cast<double>(part.x) + pw) / w - 1, 1 - (2 * static_cast<double>(part.y) + ph) / h, pw / w, ph / h};
}

}  // namespace

double dot(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point3 subtract(const Point3& a, const Point3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

CameraAxes camera_axes(const Camera& camera) {
  CameraAxes axes;
  axes.ahead = unit(subtract(camera.target, camera.eye));
  const bool vertical = std::hypot(axes.ahead[0], axes.ahead[1]) < 1e-9;
  axes.right = unit(cross(axes.ahead, vertical ? Point3{0, 1, 0} : Point3{0, 0, 1}));
  axes.up = cross(axes.right, axes.ahead);
  return axes;
}

Camera orbit_camera(const Point3& target, double azimuth_deg, double pitch_deg, double distance_m, double field_of_view_deg) {
  const double azimuth = azimuth_deg * M_PI / 180, pitch = pitch_deg * M_PI / 180;
  const Point3 back = {std::sin(azimuth) * std::cos(pitch), std::cos(azimuth) * std::cos(pitch), std::sin(pitch)};
  return {sum(target, scaled(back, distance_m)), target, field_of_view_deg};
}

Camera frame_box(const Box& box, double azimuth_deg, double pitch_deg, double field_of_view_deg, double aspect, double distance_m) {
  Point3 target = scaled(sum(box.low, box.high), 0.5);
  const Point3 span = subtract(box.high, box.low);
  double distance = distance_m > 0 ? distance_m : std::sqrt(dot(span, span));
  Camera camera = orbit_camera(target, azimuth_deg, pitch_deg, distance, field_of_view_deg);
  if (distance_m > 0) return camera;
  const HalfPlane half = half_plane(camera, aspect);
  for (int round = 0; round < 12; ++round) {
    const CameraAxes axes = camera_axes(camera);
    double left = INFINITY, right = -INFINITY, bottom = INFINITY, top = -INFINITY, nearest = INFINITY;
    for (int i = 0; i < 8; ++i) {
      const Point3 from_eye = subtract(corner(box, i), camera.eye);
      const double depth = std::max(dot(from_eye, axes.ahead), 1e-3 * distance);
      nearest = std::min(nearest, depth);
      const double x = dot(from_eye, axes.right) / depth / half.width, y = dot(from_eye, axes.up) / depth / half.height;
      left = std::min(left, x), right = std::max(right, x), bottom = std::min(bottom, y), top = std::max(top, y);
    }
    // Centre, then come closer or go back until the longer side fits.
    const double x = (left + right) / 2 * half.width * distance, y = (bottom + top) / 2 * half.height * distance;
    target = sum(target, sum(scaled(axes.right, x), scaled(axes.up, y)));
    const double share = std::max(right - left, top - bottom) / 2 / margin;
    distance = std::max(distance + (share - 1) * nearest, 0.2 * distance);
    camera = orbit_camera(target, azimuth_deg, pitch_deg, distance, field_of_view_deg);
  }
  return camera;
}

Orbit frame_box_all_round(const Box& box, std::span<const double> azimuths_deg, double pitch_deg, double field_of_view_deg, double aspect) {
  const Point3 middle = scaled(sum(box.low, box.high), 0.5);
  const HalfPlane half = half_plane({.field_of_view_deg = field_of_view_deg}, aspect);
  // A corner r from the target is seen where |r right| <= width (distance + r ahead): linear, so that the least distance is convex in the height.
  const auto distance_at = [&](double height) {
    const Point3 target = {middle[0], middle[1], height};
    double distance = 0;
    for (const double azimuth : azimuths_deg) {
      const CameraAxes axes = camera_axes(orbit_camera(target, azimuth, pitch_deg, 1, field_of_view_deg));
      for (int i = 0; i < 8; ++i) {
        const Point3 r = subtract(corner(box, i), target);
        const double across = std::max(std::abs(dot(r, axes.right)) / half.width, std::abs(dot(r, axes.up)) / half.height);
        distance = std::max(distance, across / margin - dot(r, axes.ahead));
      }
    }
    return distance;
  };
  // Within the box: from above, a higher target instead of a larger distance would do as well.
  double low = box.low[2], high = box.high[2];
  for (int round = 0; round < 80; ++round) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (distance_at(a) < distance_at(b))
      high = b;
    else
      low = a;
  }
  const double height = (low + high) / 2;
  return {{middle[0], middle[1], height}, distance_at(height)};
}

std::array<double, 16> projection_matrix(const Camera& camera, Size picture, const PicturePart& part, double near_m) {
  const CameraAxes axes = camera_axes(camera);
  const HalfPlane half = half_plane(camera, static_cast<double>(picture.width) / static_cast<double>(picture.height));
  const PartOf at = part_of(picture, part);
  std::array<double, 16> m{};
  for (std::size_t c = 0; c < 3; ++c) {
    m[4 * c + 0] = (axes.right[c] / half.width - at.x * axes.ahead[c]) / at.width;
    m[4 * c + 1] = (axes.up[c] / half.height - at.y * axes.ahead[c]) / at.height;
    m[4 * c + 3] = axes.ahead[c];
  }
  m[14] = near_m;
  return m;
}

std::array<double, 16> ray_matrix(const Camera& camera, Size picture, const PicturePart& part) {
  const CameraAxes axes = camera_axes(camera);
  const HalfPlane half = half_plane(camera, static_cast<double>(picture.width) / static_cast<double>(picture.height));
  const PartOf at = part_of(picture, part);
  std::array<double, 16> m{};
  for (std::size_t c = 0; c < 3; ++c) {
    m[c] = axes.right[c] * half.width * at.width;
    m[4 + c] = axes.up[c] * half.height * at.height;
    m[12 + c] = axes.ahead[c] + axes.right[c] * half.width * at.x + axes.up[c] * half.height * at.y;
  }
  return m;
}

bool sees(const std::array<double, 16>& projection, const Camera& camera, const Box& box) {
  int left = 0, right = 0, below = 0, above = 0, behind = 0;
  for (int i = 0; i < 8; ++i) {
    const Point3 p = subtract(corner(box, i), camera.eye);
    const auto row = [&](std::size_t r) { return projection[r] * p[0] + projection[4 + r] * p[1] + projection[8 + r] * p[2] + projection[12 + r]; };
    const double x = row(0), y = row(1), w = row(3);
    left += x < -w, right += x > w, below += y < -w, above += y > w, behind += w < 0;
  }
  return left < 8 && right < 8 && below < 8 && above < 8 && behind < 8;
}

}  // namespace arete
