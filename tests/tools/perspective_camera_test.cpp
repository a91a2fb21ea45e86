#include "tools/perspective_camera.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace arete::tools {
namespace {

/// A slope that rises by 3 m per column and 1 m per row, in cells of 10 x 20 m, with one void.
class PerspectiveCamera : public testing::Test {
 protected:
  PerspectiveCamera() : cells_(40, 30) {
    for (std::int64_t y = 0; y < 30; ++y)
      for (std::int64_t x = 0; x < 40; ++x) cells_(x, y) = static_cast<float>(100 + 3 * x + y);
    cells_(7, 9) = void_value;
    geo_.transform = {1000, 10, 0, 5000, 0, -20};
  }
  CameraPlaces find(const CameraArguments& arguments) const { return find_places(arguments, ground_); }
  std::vector<Camera> place(const CameraArguments& arguments, double exaggeration = 2) const {
    return place_cameras(arguments, find(arguments), ground_, {{0, -580, 0}, {390, 0, 246 * exaggeration}}, exaggeration, 1.5);
  }
  /// The message with which they are refused; empty where they are not.
  std::string refusal(const CameraArguments& arguments) const {
    try {
      check_camera(arguments);
      place(arguments);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
  Raster<float> cells_;
  ViewSource source_{cells_.view()};
  GeoReference geo_;
  CameraGround ground_{source_, geo_, {10, 20}};
};

TEST_F(PerspectiveCamera, FindsPlacesAndTheGroundThere) {
  // The middle of the cell in column 2, row 3.
  const Point3 place = *find({.look_at = "1025,4930"}).look_at;
  EXPECT_DOUBLE_EQ(place[0], 20);
  EXPECT_DOUBLE_EQ(place[1], -60);
  EXPECT_DOUBLE_EQ(place[2], 109);
  EXPECT_DOUBLE_EQ((*find({.look_at = "1030,4930"}).look_at)[2], 110.5);
  EXPECT_DOUBLE_EQ((*find({.look_at = "1025,4930,-7.5"}).look_at)[2], -7.5);
  EXPECT_DOUBLE_EQ((*find({.eye = "1025,4930,+2"}).eye)[2], 111);
  EXPECT_DOUBLE_EQ((*find({.eye = "1025,4930,500"}).eye)[2], 500);
  EXPECT_DOUBLE_EQ((*find({.look_at = "9000,-4e3,500"}).look_at)[0], 7995);  // outside, but its height is known
  // The rim of half a cell is as high as the samples that it lies beside.
  EXPECT_DOUBLE_EQ((*find({.look_at = "1000,5000"}).look_at)[2], 100);
}

TEST_F(PerspectiveCamera, TheGroundIsNeverBelowWhatIsDrawn) {
  cells_(20, 10) = 300;  // a peak: whichever diagonal is drawn, at most this high
  EXPECT_DOUBLE_EQ(ground_at(ground_, 200, -200), 300);
  const double beside = ground_at(ground_, 205, -210);
  EXPECT_DOUBLE_EQ(beside, (300.0 + (100 + 63 + 11)) / 2);  // the diagonal from the peak, not that between its neighbours
  EXPECT_TRUE(std::isnan(ground_at(ground_, 71, -181)));
  EXPECT_TRUE(std::isnan(ground_at(ground_, -6, 0)));
  // Half a cell beside the void the ground goes on.
  EXPECT_DOUBLE_EQ(ground_at(ground_, 64, -180), 127);
}

TEST_F(PerspectiveCamera, WithoutATransformPlacesAreColumnsAndRows) {
  const GeoReference none;
  const CameraGround ground{source_, none, {1, 1}};
  const Point3 place = *find_places({.look_at = "2.5,3.5"}, ground).look_at;
  EXPECT_DOUBLE_EQ(place[0], 2);
  EXPECT_DOUBLE_EQ(place[1], -3);
  EXPECT_DOUBLE_EQ(place[2], 109);
}

TEST_F(PerspectiveCamera, OrbitsThePlaceItLooksAt) {
  const Camera camera = place({.look_at = "1200,4700", .look_from_deg = 90, .pitch_deg = 30, .distance_m = 1000, .field_of_view_deg = 40}).front();
  EXPECT_DOUBLE_EQ(camera.target[0], 195);
  EXPECT_DOUBLE_EQ(camera.target[2], 2 * (*find({.look_at = "1200,4700"}).look_at)[2]);
  EXPECT_NEAR(camera.eye[0], 195 + 1000 * std::cos(M_PI / 6), 1e-9);
  EXPECT_NEAR(camera.eye[1], camera.target[1], 1e-9);
  EXPECT_NEAR(camera.eye[2], camera.target[2] + 500, 1e-9);
  EXPECT_EQ(camera.field_of_view_deg, 40);
}

TEST_F(PerspectiveCamera, StandsWhereItIsToldTo) {
  const Camera both = place({.look_at = "1200,4700,150", .eye = "1050,4900,+30"}, 3).front();
  EXPECT_DOUBLE_EQ(both.eye[2], 3 * ((*find({.look_at = "1050,4900"}).look_at)[2] + 30));
  EXPECT_DOUBLE_EQ(both.target[2], 450);
  const Camera eye = place({.eye = "500,4000,900"}, 3).front();
  EXPECT_EQ(eye.target, (Point3{195, -290, 246 * 3 / 2.0}));
  EXPECT_EQ(eye.eye[2], 2700);
}

TEST_F(PerspectiveCamera, SaysItsPlacesSoThatTheyCanBeGivenAgain) {
  const Camera camera = place({.look_at = "1200,4700", .look_from_deg = 70}).front();
  const auto eye = place_in_crs(camera.eye, ground_, 2), target = place_in_crs(camera.target, ground_, 2);
  const auto text = [](const std::array<double, 3>& p) { return std::to_string(p[0]) + "," + std::to_string(p[1]) + "," + std::to_string(p[2]); };
  const Camera again = place({.look_at = text(target), .eye = text(eye)}).front();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(again.eye[i], camera.eye[i], 1e-5);
    EXPECT_NEAR(again.target[i], camera.target[i], 1e-5);
  }
}

TEST_F(PerspectiveCamera, ATurntableGoesAllRoundFromWhereItLooksFrom) {
  for (const char* look_at : {"", "1200,4700"}) {
    const std::vector<Camera> cameras = place({.look_at = look_at, .look_from_deg = 200, .turntable = 8});
    ASSERT_EQ(cameras.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_EQ(cameras[i].target, cameras[0].target);
      const Point3 back = subtract(cameras[i].eye, cameras[i].target);
      EXPECT_NEAR(std::sqrt(dot(back, back)), std::sqrt(dot(subtract(cameras[0].eye, cameras[0].target), subtract(cameras[0].eye, cameras[0].target))), 1e-6);
      const double azimuth = std::fmod(200 + 45.0 * static_cast<double>(i), 360);
      EXPECT_NEAR(std::fmod(std::atan2(back[0], back[1]) * 180 / M_PI + 360, 360), azimuth, 1e-9);
    }
  }
}

TEST_F(PerspectiveCamera, RefusesWhatContradictsItself) {
  EXPECT_NE(refusal({.eye = "1200,4700,900", .look_from_deg = 200}).find("--look-from"), std::string::npos);
  EXPECT_NE(refusal({.eye = "1200,4700,900", .pitch_deg = 20}).find("--pitch"), std::string::npos);
  EXPECT_NE(refusal({.eye = "1200,4700,900", .distance_m = 100}).find("--distance"), std::string::npos);
  EXPECT_NE(refusal({.eye = "1200,4700,900", .turntable = 4}).find("--turntable"), std::string::npos);
  EXPECT_NE(refusal({.pitch_deg = 90, .turntable = 4}).find("--pitch"), std::string::npos);
  EXPECT_NE(refusal({.look_at = "1200,4700,200", .eye = "1200,4700,200"}).find("same place"), std::string::npos);
}

TEST_F(PerspectiveCamera, RefusesPlacesThatMakeNoSense) {
  for (const char* text : {"1200", "1200,4700,1,2", "1200,x", "1200,,3", "1200,4700,", "1200,4700,+5", "nan,4700", "1200 4700"})
    EXPECT_NE(refusal({.look_at = text}).find("--look-at takes"), std::string::npos) << text;
  for (const char* text : {"1200,4700", "1200,4700,+0", "1200,4700,+-5", "1200,+4700,5", "1200,4700,5m", "inf,4700,3"})
    EXPECT_NE(refusal({.eye = text}).find("--eye takes"), std::string::npos) << text;
  EXPECT_NE(refusal({.look_at = "999,4700"}).find("outside the DEM (X 1000 to 1400, Y 4400 to 5000)"), std::string::npos);
  EXPECT_NE(refusal({.eye = "1200,4399,+5"}).find("outside the DEM"), std::string::npos);
  EXPECT_NE(refusal({.look_at = "1075,4810"}).find("void"), std::string::npos);
  EXPECT_EQ(refusal({.look_at = "1075,4810,120"}), "");
  EXPECT_NE(refusal({.eye = "1025,4930,108.9"}).find("under the ground, which is 109.0 m high"), std::string::npos);
  EXPECT_EQ(refusal({.eye = "1025,4930,109.1"}), "");
  // The slope rises to the east: close by and low the camera would stand in it.
  EXPECT_NE(refusal({.look_at = "1100,4700", .look_from_deg = 90, .pitch_deg = 5, .distance_m = 150}).find("under the ground"), std::string::npos);
  EXPECT_EQ(refusal({.look_at = "1100,4700", .look_from_deg = 270, .pitch_deg = 5, .distance_m = 50}), "");
}

}  // namespace
}  // namespace arete::tools
