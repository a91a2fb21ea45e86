#include "tools/perspective_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/support/error.h"

namespace arete::tools {
namespace {

using Transform = std::array<double, 6>;

constexpr double default_look_from_deg = 200, default_pitch_deg = 35;

/// Without a transform x and y are columns and rows.
Transform transform_of(const GeoReference& geo) { return geo.transform.value_or(Transform{0, 1, 0, 0, 0, 1}); }

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorKind::usage, message); }

/// The numbers of "1,2.5,-3"; none where it is not that.
std::vector<double> parse_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string word = text.substr(from, to - from);
    std::size_t read = 0;
    double number = NAN;
    try {
      number = std::stod(word, &read);
    } catch (const std::exception&) {
      return {};
    }
    if (read != word.size() || !std::isfinite(number)) return {};
    numbers.push_back(number);
    from = to + 1;
  }
  return numbers;
}

/// A place as the user writes it; the height is NaN where it is not given, and above the ground where it has a sign.
struct WrittenPlace {
  double x = 0, y = 0, z = NAN;
  bool above_ground = false;
};

WrittenPlace parse_look_at(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text);
  if (numbers.size() < 2 || numbers.size() > 3 || text.find('+') != std::string::npos)
    refuse("--look-at takes X,Y or X,Y,Z in the CRS of the DEM, Z in metres, not '" + text + "'");
  return {numbers[0], numbers[1], numbers.size() == 3 ? numbers[2] : NAN, false};
}

WrittenPlace parse_eye(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text);
  const std::size_t sign = text.find('+');
  const bool above_ground = sign != std::string::npos && sign > 0 && sign == text.rfind(',') + 1;
  if (numbers.size() != 3 || (sign != std::string::npos && !above_ground) || (above_ground && !(numbers[2] > 0)))
    refuse("--eye takes X,Y,Z or X,Y,+H in the CRS of the DEM, Z in metres and H in metres above the ground, not '" + text + "'");
  return {numbers[0], numbers[1], numbers[2], above_ground};
}

std::string extent_of(const CameraGround& ground) {
  const Transform t = transform_of(ground.geo);
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int corner = 0; corner < 4; ++corner) {
    const double column = corner & 1 ? static_cast<double>(ground.source.size().width) : 0, row = corner & 2 ? static_cast<double>(ground.source.size().height) : 0;
    const double at[2] = {t[0] + column * t[1] + row * t[2], t[3] + column * t[4] + row * t[5]};
    for (int i = 0; i < 2; ++i) low[i] = std::min(low[i], at[i]), high[i] = std::max(high[i], at[i]);
  }
  return fmt::format("X {:.10g} to {:.10g}, Y {:.10g} to {:.10g}", low[0], high[0], low[1], high[1]);
}

Point3 find_place(const WrittenPlace& written, const std::string& option, const std::string& text, const CameraGround& ground) {
  const auto [column, row] = cell_at(transform_of(ground.geo), written.x, written.y);
  Point3 place = {(column - 0.5) * ground.cell.x_m, (0.5 - row) * ground.cell.y_m, written.z};
  if (!std::isnan(written.z) && !written.above_ground) return place;
  const Size size = ground.source.size();
  const std::string instead = option + (written.above_ground ? " X,Y,Z" : " X,Y,Z with a height Z");
  if (!(column >= 0 && row >= 0 && column <= static_cast<double>(size.width) && row <= static_cast<double>(size.height)))
    refuse(fmt::format("{} {} lies outside the DEM ({}), where no ground is known: give {}", option, text, extent_of(ground), instead));
  const double height = ground_at(ground, place[0], place[1]);
  if (std::isnan(height)) refuse(fmt::format("{} {} lies in a void of the DEM, where no ground is known: give {}", option, text, instead));
  place[2] = written.above_ground ? height + written.z : height;
  return place;
}

Point3 stretched(const Point3& place, double exaggeration) { return {place[0], place[1], place[2] * exaggeration}; }

double distance_between(const Point3& a, const Point3& b) {
  const Point3 d = subtract(a, b);
  return std::sqrt(dot(d, d));
}

/// Throws where the eye lies under the ground. It may stand outside the DEM, and in voids.
void check_above_ground(const Camera& camera, double look_from_deg, const CameraGround& ground, double exaggeration) {
  const double height = ground_at(ground, camera.eye[0], camera.eye[1]);
  if (std::isnan(height) || camera.eye[2] > height * exaggeration) return;
  refuse(fmt::format("seen from {:g} degrees the camera would stand {:.3g} m under the ground: raise --pitch, change --distance, or look at a higher place",
                     look_from_deg, height - camera.eye[2] / exaggeration));
}

}  // namespace

void check_camera(const CameraArguments& arguments) {
  const auto clash = [](const std::string& option) { refuse("--eye says where the camera stands: leave out " + option + ", or --eye"); };
  if (!arguments.look_at.empty()) parse_look_at(arguments.look_at);
  if (!arguments.eye.empty()) {
    parse_eye(arguments.eye);
    if (arguments.look_from_deg) clash("--look-from");
    if (arguments.pitch_deg) clash("--pitch");
    if (arguments.distance_m) clash("--distance");
    if (arguments.turntable > 0) clash("--turntable");
  }
  if (arguments.turntable > 0 && arguments.pitch_deg == 90) refuse("from straight above all pictures of --turntable are the same: give a --pitch below 90");
}

double grid_north_deg(const CameraGround& ground) {
  const Transform t = transform_of(ground.geo);
  if (!ground.geo.transform) return 0;
  // Columns and rows per unit northwards.
  const double determinant = t[1] * t[5] - t[2] * t[4], columns = -t[2] / determinant, rows = t[1] / determinant;
  return std::atan2(columns * ground.cell.x_m, -rows * ground.cell.y_m) * 180 / M_PI;
}

double metres_per_pixel(const Camera& camera, std::int64_t height) {
  return 2 * std::tan(camera.field_of_view_deg * M_PI / 360) * distance_between(camera.eye, camera.target) / static_cast<double>(height);
}

double ground_at(const CameraGround& ground, double x_m, double y_m) {
  const Size size = ground.source.size();
  const double column = x_m / ground.cell.x_m, row = -y_m / ground.cell.y_m;  // of samples
  if (!(column >= -0.5 && row >= -0.5 && column <= static_cast<double>(size.width) - 0.5 && row <= static_cast<double>(size.height) - 0.5))
    return std::numeric_limits<double>::quiet_NaN();
  const auto first = [](double at, std::int64_t count) {
    return std::clamp(static_cast<std::int64_t>(std::floor(at)), std::int64_t{0}, std::max<std::int64_t>(0, count - 2));
  };
  const std::int64_t x = first(column, size.width), y = first(row, size.height);
  Raster<float> samples(std::min<std::int64_t>(2, size.width), std::min<std::int64_t>(2, size.height));
  ground.source.read({x, y, samples.width(), samples.height()}, samples.view());
  const double u = std::clamp(column - static_cast<double>(x), 0.0, 1.0), v = std::clamp(row - static_cast<double>(y), 0.0, 1.0);
  const auto sample = [&](std::int64_t i, std::int64_t j) { return samples(std::min(i, samples.width() - 1), std::min(j, samples.height() - 1)); };
  // Beside a void the ground goes on as high as the nearest sample.
  const float own = sample(u >= 0.5, v >= 0.5);
  const auto height = [&](std::int64_t i, std::int64_t j) { return static_cast<double>(is_void(sample(i, j)) ? own : sample(i, j)); };
  const double nw = height(0, 0), ne = height(1, 0), sw = height(0, 1), se = height(1, 1);
  const double falling = u > v ? nw + u * (ne - nw) + v * (se - ne) : nw + v * (sw - nw) + u * (se - sw);
  const double rising = u + v < 1 ? nw + u * (ne - nw) + v * (sw - nw) : se + (1 - u) * (sw - se) + (1 - v) * (ne - se);
  return std::max(falling, rising);
}

CameraPlaces find_places(const CameraArguments& arguments, const CameraGround& ground) {
  CameraPlaces places;
  if (!arguments.look_at.empty()) places.look_at = find_place(parse_look_at(arguments.look_at), "--look-at", arguments.look_at, ground);
  if (arguments.eye.empty()) return places;
  places.eye = find_place(parse_eye(arguments.eye), "--eye", arguments.eye, ground);
  const double height = ground_at(ground, (*places.eye)[0], (*places.eye)[1]);
  if ((*places.eye)[2] <= height)
    refuse(fmt::format("--eye {} lies under the ground, which is {:.1f} m high there: raise it, or give its height above the ground as +H", arguments.eye, height));
  if (places.look_at && distance_between(*places.look_at, *places.eye) < 1e-6) refuse("--eye and --look-at are the same place: move one of them");
  return places;
}

std::vector<Camera> place_cameras(const CameraArguments& arguments, const CameraPlaces& places, const CameraGround& ground, const Box& box, double exaggeration,
                                  double aspect) {
  const double north = grid_north_deg(ground), look_from = arguments.look_from_deg.value_or(default_look_from_deg) + north, pitch = arguments.pitch_deg.value_or(default_pitch_deg);
  const double field = arguments.field_of_view_deg;
  const Point3 middle = {(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2, (box.low[2] + box.high[2]) / 2};
  if (places.eye) return {{stretched(*places.eye, exaggeration), places.look_at ? stretched(*places.look_at, exaggeration) : middle, field}};

  const int count = std::max(1, arguments.turntable);
  std::vector<double> azimuths;
  for (int i = 0; i < count; ++i) azimuths.push_back(std::fmod(look_from + 360.0 * i / count, 360));
  const Camera whole = frame_box(box, look_from, pitch, field, aspect, arguments.distance_m.value_or(0));
  // Round a place as far away as shows the whole terrain, so that all is seen as large.
  Orbit orbit{whole.target, arguments.distance_m.value_or(distance_between(whole.eye, whole.target))};
  if (places.look_at)
    orbit.target = stretched(*places.look_at, exaggeration);
  else if (arguments.turntable > 0 && !arguments.distance_m)
    orbit = frame_box_all_round(box, azimuths, pitch, field, aspect);
  std::vector<Camera> cameras;
  for (const double azimuth : azimuths) {
    cameras.push_back(orbit_camera(orbit.target, azimuth, pitch, orbit.distance_m, field));
    if (!places.look_at && arguments.turntable == 0) cameras.back() = whole;
    check_above_ground(cameras.back(), azimuth - north, ground, exaggeration);
  }
  return cameras;
}

std::array<double, 3> place_in_crs(const Point3& place, const CameraGround& ground, double exaggeration) {
  const Transform t = transform_of(ground.geo);
  const double column = place[0] / ground.cell.x_m + 0.5, row = 0.5 - place[1] / ground.cell.y_m;
  return {t[0] + column * t[1] + row * t[2], t[3] + column * t[4] + row * t[5], place[2] / exaggeration};
}

}  // namespace arete::tools
