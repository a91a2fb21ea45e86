#pragma once

#include <array>
#include <span>

#include "core/terrain/georeference.h"
#include "core/terrain/raster.h"

namespace arete {

/// Metres from the first sample of a terrain: east, north, up. Up is in exaggerated metres above the DEM's zero.
using Point3 = std::array<double, 3>;

double dot(const Point3& a, const Point3& b);
Point3 subtract(const Point3& a, const Point3& b);

/// Looks from `eye` to `target`, upright. Perspective with the vertical field of view; straight down, north is at the top.
struct Camera {
  Point3 eye = {0, 0, 1};
  Point3 target = {0, 0, 0};
  double field_of_view_deg = 30;
};

/// The directions of a picture: to the right, upwards, and into it. Orthonormal.
struct CameraAxes {
  Point3 right, up, ahead;
};
CameraAxes camera_axes(const Camera& camera);

/// A box of a terrain: x east, y north (downwards the rows grow, so that y is negative), z up.
struct Box {
  Point3 low, high;
};

/// Looks at the target from a compass direction, `pitch_deg` above it (90: from straight above), that far away.
Camera orbit_camera(const Point3& target, double azimuth_deg, double pitch_deg, double distance_m, double field_of_view_deg);

/// The camera from that direction that shows the whole box, in the middle of the picture, with a margin of 4 %. `distance_m` > 0
/// looks at the middle of the box from that far.
Camera frame_box(const Box& box, double azimuth_deg, double pitch_deg, double field_of_view_deg, double aspect, double distance_m = 0);

/// A target to turn round, and how far away.
struct Orbit {
  Point3 target = {0, 0, 0};
  double distance_m = 1;
};

/// The closest orbit round the middle of the box, at the height in it that suits best, from which it is seen whole from each of those compass directions, with
/// the margin of frame_box.
Orbit frame_box_all_round(const Box& box, std::span<const double> azimuths_deg, double pitch_deg, double field_of_view_deg, double aspect);

/// Part of a picture, in pixels from its upper left corner.
struct PicturePart {
  std::int64_t x = 0, y = 0, width = 0, height = 0;
};

/// Column-major matrix for OpenGL, from positions relative to the eye to clip coordinates of that part of a picture. Depth is
/// reversed and without far plane: 1 at `near_m`, 0 at infinity.
std::array<double, 16> projection_matrix(const Camera& camera, Size picture, const PicturePart& part, double near_m);
/// From clip coordinates x, y of that part to the direction of the ray.
std::array<double, 16> ray_matrix(const Camera& camera, Size picture, const PicturePart& part);

/// Whether any of the box may be seen in that part.
bool sees(const std::array<double, 16>& projection, const Camera& camera, const Box& box);

}  // namespace arete
