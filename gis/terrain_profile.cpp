#include "gis/terrain_profile.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/support/error.h"
#include "core/terrain/surface.h"
#include "gis/geodesy.h"
#include "gis/legend.h"

namespace arete {
namespace {

using Transform = std::array<double, 6>;

/// Without a transform x and y are columns and rows.
Transform transform_of(const GeoReference& geo) { return geo.transform.value_or(Transform{0, 1, 0, 0, 0, 1}); }

std::array<double, 2> place_of(const Transform& t, double column, double row) {
  return {t[0] + column * t[1] + row * t[2], t[3] + column * t[4] + row * t[5]};
}

constexpr Colour paper = {255, 255, 255, 255}, ink = {38, 40, 44, 255}, grid = {226, 228, 232, 255};

void mix(Colour& pixel, Colour colour, double share) {
  for (std::size_t i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(std::lround(pixel[i] + share * (colour[i] - pixel[i])));
}

/// The frame of the drawing in pixels, and the values at its sides.
struct Frame {
  std::int64_t left, top, right, bottom;
  double length_m, low_m, high_m;
  double x_of(double distance) const { return static_cast<double>(left) + distance / length_m * static_cast<double>(right - left); }
  double y_of(double elevation) const {
    return static_cast<double>(bottom) - (elevation - low_m) / (high_m - low_m) * static_cast<double>(bottom - top);
  }
  double metres_per_pixel() const { return length_m / static_cast<double>(right - left); }
};

/// The elevation at a distance, straight between points; NaN beside a void.
double elevation_at(const std::vector<ProfilePoint>& points, double distance) {
  const auto after = std::upper_bound(points.begin(), points.end(), distance, [](double d, const ProfilePoint& p) { return d < p.distance_m; });
  if (after == points.begin()) return points.front().elevation_m;
  if (after == points.end()) return points.back().elevation_m;
  const ProfilePoint &a = *(after - 1), &b = *after;
  return std::lerp(a.elevation_m, b.elevation_m, (distance - a.distance_m) / (b.distance_m - a.distance_m));
}

/// The largest of 1, 1.5, 2, 3, 5, 7 times a power of ten that is not above `most`; at least a hundredth.
double round_exaggeration(double most) {
  double best = 0.01;
  for (double power = 0.01; power <= most; power *= 10)
    for (const double digit : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0})
      if (digit * power <= most) best = digit * power;
  return best;
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

Range range_of(const std::vector<ProfilePoint>& points) {
  Range range;
  for (const ProfilePoint& p : points)
    if (std::isfinite(p.elevation_m)) range.low = std::min(range.low, p.elevation_m), range.high = std::max(range.high, p.elevation_m);
  return range;
}

void draw_grid(Picture& picture, const Frame& frame, int size) {
  const std::vector<double> heights = round_ticks(frame.low_m, frame.high_m, 6);
  const double height_step = heights.size() > 1 ? heights[1] - heights[0] : 1;
  for (const double h : heights) {
    const auto y = static_cast<std::int64_t>(std::lround(frame.y_of(h)));
    fill(picture, {frame.left, y, frame.right - frame.left, 1}, grid);
    draw_text(picture, frame.left - size / 2, y + size / 3, format_tick(h, height_step), size, ink, Align::right);
  }
  const bool kilometres = frame.length_m >= 2000;
  const double unit = kilometres ? 1000 : 1;
  const std::vector<double> distances = round_ticks(0, frame.length_m / unit, 10);
  const double step = distances.size() > 1 ? distances[1] - distances[0] : 1;
  for (const double d : distances) {
    const auto x = static_cast<std::int64_t>(std::lround(frame.x_of(d * unit)));
    fill(picture, {x, frame.bottom, 1, size / 3}, ink);
    draw_text(picture, x, frame.bottom + 3 * size / 2, format_tick(d, step), size, ink, Align::centre);
  }
  draw_text(picture, frame.right, frame.bottom + 3 * size, kilometres ? "distance, km" : "distance, m", size, ink, Align::right);
  draw_text(picture, frame.left - size / 2, frame.top - size, "m", size, ink, Align::right);
}

/// Each column of pixels is the mean of eight narrow ones: the line of the ground is smooth.
void draw_ground(Picture& picture, const std::vector<ProfilePoint>& points, const Frame& frame, const ColourRamp& ramp, const Range& range, double line_width) {
  constexpr int parts = 8;
  const Picture no_data = hatching(frame.right - frame.left, frame.bottom - frame.top);
  const double span = std::max(1e-9, range.high - range.low);
  for (std::int64_t x = frame.left; x < frame.right; ++x) {
    std::array<double, parts> tops{}, lines{};
    bool known = true;
    for (int i = 0; i < parts; ++i) {
      const double at = (static_cast<double>(x - frame.left) + (i + 0.5) / parts) * frame.metres_per_pixel();
      const double here = elevation_at(points, at), beside = elevation_at(points, std::min(frame.length_m, at + frame.metres_per_pixel() / parts));
      known = known && std::isfinite(here) && std::isfinite(beside);
      tops[static_cast<std::size_t>(i)] = frame.y_of(here);
      // As thick across a slope as along the flat.
      const double slope = (frame.y_of(beside) - frame.y_of(here)) * parts;
      lines[static_cast<std::size_t>(i)] = line_width * std::sqrt(1 + std::min(400.0, slope * slope));
    }
    for (std::int64_t y = frame.top; y < frame.bottom; ++y) {
      Colour& pixel = picture(x, y);
      if (!known) {
        pixel = no_data(x - frame.left, y - frame.top);
        continue;
      }
      double ground = 0, line = 0;
      for (std::size_t i = 0; i < tops.size(); ++i) {
        const double row = static_cast<double>(y), top = tops[i] - lines[i] / 2, end = tops[i] + lines[i] / 2;
        ground += std::clamp(row + 1 - tops[i], 0.0, 1.0) / parts;
        line += std::max(0.0, std::min(row + 1, end) - std::max(row, top)) / parts;
      }
      const double elevation = frame.low_m + (static_cast<double>(frame.bottom - y) - 0.5) / static_cast<double>(frame.bottom - frame.top) * (frame.high_m - frame.low_m);
      mix(pixel, ramp.at((elevation - range.low) / span), ground);
      mix(pixel, ink, std::min(1.0, line));
    }
  }
}

}  // namespace

MapLine middle_line(const GeoReference& geo, Size size) {
  const Transform t = transform_of(geo);
  const double row = static_cast<double>(size.height) / 2;
  return {place_of(t, 0, row), place_of(t, static_cast<double>(size.width), row)};
}

std::vector<ProfilePoint> sample_profile(const RasterSource& source, const GeoReference& geo, const MapLine& line) {
  constexpr std::int64_t most = 20000;
  const Transform t = transform_of(geo);
  const std::array<double, 2> from = cell_at(t, line.from[0], line.from[1]), to = cell_at(t, line.to[0], line.to[1]);
  const double cells = std::hypot(to[0] - from[0], to[1] - from[1]);
  if (!std::isfinite(cells) || cells == 0) throw Error(ErrorKind::usage, "a profile needs a line between two different places");
  const std::int64_t steps = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::min(1e9, std::ceil(2 * cells))), 2, most - 1);
  SurfaceSampler surface(source);
  std::vector<ProfilePoint> points;
  std::vector<std::array<double, 2>> places;
  for (std::int64_t i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    places.push_back({std::lerp(line.from[0], line.to[0], share), std::lerp(line.from[1], line.to[1], share)});
    points.push_back({0, surface.at(std::lerp(from[0], to[0], share), std::lerp(from[1], to[1], share)).elevation_m});
  }
  const std::vector<double> distances = distances_along(geo, places);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].distance_m = distances[i];
  return points;
}

DrawnProfile draw_profile(const std::vector<ProfilePoint>& points, const ColourRamp& ramp, const ProfileDrawing& options) {
  const Range range = range_of(points);
  if (!(range.low <= range.high)) throw Error(ErrorKind::input, "the line of the profile meets no valid cell");
  const int size = std::max(11, font_size_for(options.width));
  Picture picture(options.width, options.height, paper);
  Frame frame{5 * size, 3 * size + (options.title.empty() ? 0 : 2 * size), options.width - 2 * size, options.height - 4 * size, points.back().distance_m, 0, 0};
  const auto rows = static_cast<double>(frame.bottom - frame.top);
  if (frame.right - frame.left < 16 || rows < 16) throw Error(ErrorKind::usage, "the drawing of a profile needs more pixels");
  constexpr double air = 1.15;  // of the range of the elevations
  const double relief = std::max(range.high - range.low, 1e-3), most = rows * frame.metres_per_pixel() / relief;
  const double exaggeration = options.exaggeration > 0 ? options.exaggeration : round_exaggeration(most / air);
  if (exaggeration > most) {
    char text[160];
    std::snprintf(text, sizeof text, "heights exaggerated %g times do not fit into the profile: %.3g times is the most", exaggeration, most);
    throw Error(ErrorKind::usage, text);
  }
  const double shown = rows * frame.metres_per_pixel() / exaggeration;
  frame.low_m = range.low - (shown - (range.high - range.low)) / 3;
  frame.high_m = frame.low_m + shown;
  if (!options.title.empty()) draw_text(picture, frame.left, 2 * size + size / 2, options.title, size + size / 4, ink);
  char note[64];
  if (exaggeration == 1) std::snprintf(note, sizeof note, "heights to scale");
  else std::snprintf(note, sizeof note, "heights exaggerated %g times", exaggeration);
  draw_text(picture, frame.right, 2 * size + size / 2, note, size, ink, Align::right);
  draw_grid(picture, frame, size);
  draw_ground(picture, points, frame, ramp, range, std::max(1.2, static_cast<double>(options.width) / 900));
  fill(picture, {frame.left, frame.bottom, frame.right - frame.left, 1}, ink);
  return {std::move(picture), exaggeration};
}

}  // namespace arete
