#include "shaders/camera.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace arete {
namespace {

const Box box = {{0, -8000, -500}, {10000, 0, 1400}};

/// The largest |x| or |y| of the corners of the box in the picture: 1 at its sides.
double largest_share(const Camera& camera, double aspect) {
  const auto m = projection_matrix(camera, {static_cast<std::int64_t>(1000 * aspect), 1000}, {0, 0, static_cast<std::int64_t>(1000 * aspect), 1000}, 1);
  double largest = 0;
  for (int i = 0; i < 8; ++i) {
    const Point3 corner = {i & 1 ? box.high[0] : box.low[0], i & 2 ? box.high[1] : box.low[1], i & 4 ? box.high[2] : box.low[2]};
    const Point3 p = subtract(corner, camera.eye);
    const auto row = [&](std::size_t r) { return m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]; };
    EXPECT_GT(row(3), 0);
    largest = std::max({largest, std::abs(row(0) / row(3)), std::abs(row(1) / row(3))});
  }
  return largest;
}

TEST(FrameBoxAllRound, IsTheClosestOrbitThatShowsTheWholeBoxFromEachSide) {
  std::vector<double> azimuths;
  for (int i = 0; i < 24; ++i) azimuths.push_back(15.0 * i + 7);
  for (const double aspect : {0.5, 1.0, 2.0})
    for (const double pitch : {5.0, 35.0, 80.0}) {
      const Orbit orbit = frame_box_all_round(box, azimuths, pitch, 30, aspect);
      EXPECT_EQ(orbit.target[0], 5000);
      EXPECT_EQ(orbit.target[1], -4000);
      const auto share_at = [&](double height, double distance) {
        double share = 0;
        for (const double azimuth : azimuths) share = std::max(share, largest_share(orbit_camera({5000, -4000, height}, azimuth, pitch, distance, 30), aspect));
        return share;
      };
      EXPECT_NEAR(share_at(orbit.target[2], orbit.distance_m), 0.96, 1e-6);
      // From as far away, no other height in the box shows it smaller.
      for (double height = -500; height <= 1400; height += 100) EXPECT_GE(share_at(height, orbit.distance_m), 0.96 - 1e-6) << aspect << ' ' << pitch;
    }
}

}  // namespace
}  // namespace arete
