#include "tools/north_needle.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace arete::tools {
namespace {

/// Where the needle of a camera points, degrees clockwise from upwards: to its dark pixel that is farthest from its middle on the ground, which is seen from
/// `pitch_deg` above.
double shown_direction(const Camera& camera, double pitch_deg, double grid_north_deg = 0) {
  const char* before = std::getenv("ARETE_FONT");
  const std::string kept = before ? before : "";
  setenv("ARETE_FONT", "/nonexistent.ttf", 1);  // no letter
  Picture picture(900, 300);
  draw_north(picture, 0, 300, camera, grid_north_deg);
  before ? setenv("ARETE_FONT", kept.c_str(), 1) : unsetenv("ARETE_FONT");
  const double middle_x = 900 - 1.9 * 20, middle_y = 300 - 1.9 * 20;
  double farthest = 0, direction = NAN;
  for (std::int64_t y = 200; y < 300; ++y)
    for (std::int64_t x = 800; x < 900; ++x) {
      const double dx = static_cast<double>(x) + 0.5 - middle_x, dy = (static_cast<double>(y) + 0.5 - middle_y) / std::sin(pitch_deg * M_PI / 180);
      if (picture(x, y)[0] > 180 || std::hypot(dx, dy) <= farthest) continue;
      farthest = std::hypot(dx, dy);
      direction = std::atan2(dx, -dy) * 180 / M_PI;
    }
  return direction;
}

double apart(double a, double b) { return std::abs(std::remainder(a - b, 360)); }

TEST(NorthNeedle, PointsNorth) {
  for (const double pitch : {90.0, 60.0, 45.0})
    for (const double look_from : {180.0, 270.0, 0.0, 90.0}) {
      const double wanted = pitch == 90 ? 0 : 180 - look_from;  // straight down, north is at the top
      EXPECT_LT(apart(shown_direction(orbit_camera({500, -700, 90}, look_from, pitch, 3000, 30), pitch), wanted), 6) << pitch << ' ' << look_from;
    }
  // The screen direction of the projected point north of the target.
  const Camera camera = orbit_camera({0, 0, 0}, 215, 40, 1000, 30);
  const CameraAxes axes = camera_axes(camera);
  EXPECT_LT(apart(shown_direction(camera, 40), std::atan2(axes.right[1], axes.up[1] / std::sin(40 * M_PI / 180)) * 180 / M_PI), 6);
}

TEST(NorthNeedle, CanBeReadFromLowAndFromBelow) {
  for (const double pitch : {5.0, 0.0, -30.0})
    for (const double look_from : {180.0, 270.0, 0.0, 90.0})
      EXPECT_LT(apart(shown_direction(orbit_camera({0, 0, 0}, look_from, pitch, 1000, 30), 20), 180 - look_from), 8) << pitch << ' ' << look_from;
}

TEST(NorthNeedle, FollowsTheGridOfRotatedRasters) {
  EXPECT_LT(apart(shown_direction(orbit_camera({0, 0, 0}, 180, 60, 1000, 30), 60, 90), 90), 6);
}

TEST(NorthNeedle, IsTheSameInPartsOfThePicture) {
  const Camera camera = orbit_camera({0, 0, 0}, 130, 40, 1000, 30);
  Picture whole(500, 300, {90, 140, 190, 255});
  draw_north(whole, 0, 300, camera, 0);
  for (std::int64_t y = 0; y < 300; y += 15) {
    Picture rows(500, 15, {90, 140, 190, 255});
    draw_north(rows, y, 300, camera, 0);
    for (std::int64_t i = 0; i < 500 * 15; ++i) ASSERT_EQ(rows.data()[i], whole.data()[500 * y + i]) << y;
  }
}

}  // namespace
}  // namespace arete::tools
