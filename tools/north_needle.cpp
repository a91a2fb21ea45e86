#include "tools/north_needle.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace arete::tools {
namespace {

struct Place {
  double x, y;
};

/// Mixes a colour in where a convex or concave polygon covers the pixel, by 4 x 4 samples.
void fill_polygon(Picture& picture, const std::vector<Place>& corners, Colour colour) {
  double low_x = corners[0].x, high_x = low_x, low_y = corners[0].y, high_y = low_y;
  for (const Place& p : corners) low_x = std::min(low_x, p.x), high_x = std::max(high_x, p.x), low_y = std::min(low_y, p.y), high_y = std::max(high_y, p.y);
  const auto inside = [&](double x, double y) {
    bool odd = false;
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
      if ((corners[i].y > y) != (corners[j].y > y) &&
          x < corners[i].x + (y - corners[i].y) / (corners[j].y - corners[i].y) * (corners[j].x - corners[i].x))
        odd = !odd;
    return odd;
  };
  Picture dot(1, 1, colour);
  for (auto y = static_cast<std::int64_t>(std::floor(low_y)); y <= static_cast<std::int64_t>(high_y); ++y)
    for (auto x = static_cast<std::int64_t>(std::floor(low_x)); x <= static_cast<std::int64_t>(high_x); ++x) {
      int hits = 0;
      for (int s = 0; s < 16; ++s) hits += inside(static_cast<double>(x) + (s % 4 + 0.5) / 4, static_cast<double>(y) + (s / 4 + 0.5) / 4);
      dot(0, 0) = {colour[0], colour[1], colour[2], static_cast<std::uint8_t>(colour[3] * hits / 16)};
      if (hits > 0) paste(picture, dot, x, y);
    }
}

/// The camera, or from the same side one that looks down at 20 degrees, if it does less.
Camera seen_from_above(const Camera& camera) {
  constexpr double least_deg = 20;
  const Point3 back = subtract(camera.eye, camera.target);
  const double level = std::hypot(back[0], back[1]);
  if (std::atan2(back[2], level) >= least_deg * M_PI / 180) return camera;
  return orbit_camera({0, 0, 0}, std::atan2(back[0], back[1]) * 180 / M_PI, least_deg, 1, camera.field_of_view_deg);
}

}  // namespace

void draw_north(Picture& rows, std::int64_t y, std::int64_t picture_height, const Camera& camera, double grid_north_deg) {
  const CameraAxes axes = camera_axes(seen_from_above(camera));
  const double radius = std::clamp(static_cast<double>(rows.width()) / 45, 16.0, 60.0);
  const Place centre{static_cast<double>(rows.width()) - 1.9 * radius, static_cast<double>(picture_height - y) - 1.9 * radius};
  const auto place = [&](double azimuth_deg, double length) -> Place {
    const double azimuth = (azimuth_deg + grid_north_deg) * M_PI / 180;
    const Point3 p{std::sin(azimuth) * length * radius, std::cos(azimuth) * length * radius, 0};
    return {centre.x + dot(p, axes.right), centre.y - dot(p, axes.up)};
  };
  const Colour dark{45, 45, 48, 255}, pale{252, 252, 250, 255};
  fill_polygon(rows, {place(0, 1), place(145, 0.8), place(180, 0.4), place(215, 0.8)}, dark);
  fill_polygon(rows, {place(-1.5, 0.8), place(181.5, 0.37), place(212.5, 0.68)}, pale);
  const int size = std::max(12, static_cast<int>(radius * 0.6));
  // As far before the tip in any direction.
  const Place tip = place(0, 1);
  const double length = std::max(1.0, std::hypot(tip.x - centre.x, tip.y - centre.y)), step = 0.65 * size / length;
  const Place letter{tip.x + step * (tip.x - centre.x), tip.y + step * (tip.y - centre.y)};
  draw_text(rows, std::llround(letter.x), std::llround(letter.y + 0.35 * size), "N", size, dark, Align::centre);
}

}  // namespace arete::tools
