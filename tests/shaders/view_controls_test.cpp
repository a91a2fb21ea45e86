#include "shaders/view_controls.h"

#include <cmath>

#include <gtest/gtest.h>

namespace arete {
namespace {

/// Rolling ground of 10 x 8 km.
ViewGround rolling() {
  return {{{0, -8000, -500}, {10000, 0, 1400}}, [](double x, double y) { return 800 + 600 * std::sin(x / 900) * std::cos(y / 1100); }};
}

/// Where a point of the terrain is seen, in pixels of a window of 800 x 600.
std::array<double, 2> place(const ViewCamera& view, const Point3& point) {
  const auto m = projection_matrix(camera_of(view), {800, 600}, {0, 0, 800, 600}, 1);
  const Point3 p = subtract(point, camera_of(view).eye);
  const auto row = [&](std::size_t r) { return m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]; };
  return {(row(0) / row(3) + 1) * 400, (1 - row(1) / row(3)) * 300};
}

double distance(const Point3& a, const Point3& b) {
  const Point3 d = subtract(a, b);
  return std::sqrt(dot(d, d));
}

const ViewGround ground = rolling();
ViewCamera whole() { return whole_view(ground, 200, 35, 30, 800.0 / 600); }

TEST(ViewControls, TheWholeTerrainIsSeenAtFirst) {
  const ViewCamera view = whole();
  for (int i = 0; i < 8; ++i) {
    const auto [x, y] = place(view, {i & 1 ? 10000.0 : 0.0, i & 2 ? 0.0 : -8000.0, i & 4 ? 1400.0 : -500.0});
    EXPECT_TRUE(x > 0 && x < 800 && y > 0 && y < 600) << i;
  }
}

TEST(ViewControls, OrbitTurnsRoundTheTargetAndTheGroundFollowsTheHand) {
  ViewCamera view = whole();
  const ViewCamera before = view;
  orbit(view, 60, 0, 600, ground);
  EXPECT_EQ(view.target, before.target);
  EXPECT_NEAR(distance(camera_of(view).eye, view.target), before.distance_m, 1e-6);
  // A point on the near side of the target moves to the right.
  const Point3 near_eye = {before.target[0] + 500 * std::sin(200 * M_PI / 180), before.target[1] + 500 * std::cos(200 * M_PI / 180), before.target[2]};
  EXPECT_GT(place(view, near_eye)[0], place(before, near_eye)[0] + 5);
  orbit(view, -60, 0, 600, ground);
  EXPECT_NEAR(view.azimuth_deg, before.azimuth_deg, 1e-9);
  orbit(view, 0, 10000, 600, ground);
  EXPECT_DOUBLE_EQ(view.pitch_deg, 89.9);
  orbit(view, 0, -10000, 600, ground);
  EXPECT_DOUBLE_EQ(view.pitch_deg, 1);
}

TEST(ViewControls, PanMovesTheTargetWithTheHand) {
  ViewCamera view = whole();
  view.target = {5000, -4000, 900};
  view.pitch_deg = 60;
  const Point3 held = view.target;
  const auto before = place(view, held);
  pan(view, 40, 0, 600, ground);
  EXPECT_NEAR(place(view, held)[0] - before[0], 40, 0.5);
  EXPECT_NEAR(place(view, held)[1] - before[1], 0, 0.5);
  pan(view, 0, 30, 600, ground);
  EXPECT_NEAR(place(view, held)[1] - before[1], 30, 2);  // perspective
  for (int i = 0; i < 100; ++i) pan(view, 300, 300, 600, ground);
  for (std::size_t c = 0; c < 2; ++c) EXPECT_TRUE(view.target[c] >= ground.box.low[c] && view.target[c] <= ground.box.high[c]);
}

TEST(ViewControls, ZoomKeepsTheGroundUnderTheCursor) {
  for (const double x : {250.0, 400.0, 520.0})
    for (const double y : {280.0, 330.0}) {
      ViewCamera view = whole();
      const WindowPlace cursor{x, y, 800, 600};
      Point3 point;
      ASSERT_TRUE(pick_ground(view, cursor, ground, point));
      EXPECT_NEAR(point[2], ground.height(point[0], point[1]), 0.5);
      const double before = distance(camera_of(view).eye, point);
      for (int i = 0; i < 5; ++i) zoom(view, cursor, 1, ground);
      EXPECT_NEAR(distance(camera_of(view).eye, point), before * std::pow(0.8, 5), 0.01 * before);
      EXPECT_NEAR(place(view, point)[0], x, 1);
      EXPECT_NEAR(place(view, point)[1], y, 1);
    }
}

TEST(ViewControls, ZoomInTheSkyIsTowardsTheTarget) {
  ViewCamera view = whole();
  const WindowPlace corner{2, 2, 800, 600};
  Point3 point;
  ASSERT_FALSE(pick_ground(view, corner, ground, point));
  const ViewCamera before = view;
  zoom(view, corner, 1, ground);
  EXPECT_EQ(view.target, before.target);
  EXPECT_NEAR(view.distance_m, 0.8 * before.distance_m, 1e-6);
  zoom(view, corner, -1, ground);
  EXPECT_NEAR(view.distance_m, before.distance_m, 1e-6);
}

TEST(ViewControls, TheEyeNeverEntersTheGround) {
  ViewCamera view = whole();
  for (int i = 0; i < 400; ++i) {
    if (i % 4 == 0) zoom(view, {200.0 + i, 300, 800, 600}, 2, ground);
    if (i % 4 == 1) orbit(view, 37, -20, 600, ground);
    if (i % 4 == 2) pan(view, 50 - i % 100, 25, 600, ground);
    if (i % 4 == 3) fly(view, 800, 100, -300, ground);
    const Point3 eye = camera_of(view).eye;
    if (eye[0] < 0 || eye[0] > 10000 || eye[1] > 0 || eye[1] < -8000) continue;
    ASSERT_GT(eye[2], ground.height(eye[0], eye[1])) << i;
  }
}

TEST(ViewControls, LookingTurnsTheEyeInItsPlace) {
  ViewCamera view = whole();
  const Point3 eye = camera_of(view).eye, point = view.target;
  look(view, 50, -20, 600);
  EXPECT_LT(distance(camera_of(view).eye, eye), 1e-6 * view.distance_m);
  EXPECT_NEAR(place(view, point)[0], 450, 10);  // about as far as the hand
  EXPECT_NEAR(place(view, point)[1], 280, 5);
  look(view, 0, 100000, 600);
  EXPECT_DOUBLE_EQ(view.pitch_deg, -80);
}

TEST(ViewControls, FlightGoesWhereItLooks) {
  ViewCamera view = whole();
  const Point3 eye = camera_of(view).eye, ahead = camera_axes(camera_of(view)).ahead;
  fly(view, 1000, 0, 0, ground);
  const Point3 moved = subtract(camera_of(view).eye, eye);
  EXPECT_NEAR(dot(moved, ahead), 1000, 1e-6);
  fly(view, -1000, 0, 250, ground);
  EXPECT_NEAR(camera_of(view).eye[2] - eye[2], 250, 1e-6);
  const double high = flight_speed(view, ground);
  view.target[2] -= 1500;
  EXPECT_LT(flight_speed(view, ground), high);
  EXPECT_GT(flight_speed(view, ground), 0);
  for (int i = 0; i < 100; ++i) fly(view, -1e6, 0, 0, ground);
  EXPECT_LT(distance(camera_of(view).eye, {5000, -4000, 500}), 70000);
}

TEST(ViewControls, TheSunStaysInTheSky) {
  ViewSun sun;
  turn_sun(sun, 90, 10);
  EXPECT_DOUBLE_EQ(sun.azimuth_deg, 45);
  EXPECT_DOUBLE_EQ(sun.elevation_deg, 50);
  turn_sun(sun, -100, 500);
  EXPECT_DOUBLE_EQ(sun.azimuth_deg, 305);
  EXPECT_DOUBLE_EQ(sun.elevation_deg, 89);
  turn_sun(sun, 0, -500);
  EXPECT_DOUBLE_EQ(sun.elevation_deg, 2);
}

TEST(ViewControls, TheColoursComeRound) {
  GroundColour colour = GroundColour::height;
  for (const GroundColour next : {GroundColour::slope, GroundColour::aspect, GroundColour::height}) EXPECT_EQ(colour = next_colour(colour), next);
}

TEST(ViewControls, TheLayoutsComeRoundAndTheDividerStaysInside) {
  ViewLayout layout = ViewLayout::side_by_side;
  for (const ViewLayout next : {ViewLayout::swipe, ViewLayout::first, ViewLayout::second, ViewLayout::side_by_side}) EXPECT_EQ(layout = next_layout(layout), next);
  EXPECT_DOUBLE_EQ(clamp_divider(-1), 0.02);
  EXPECT_DOUBLE_EQ(clamp_divider(0.4), 0.4);
  EXPECT_DOUBLE_EQ(clamp_divider(7), 0.98);
}

}  // namespace
}  // namespace arete
