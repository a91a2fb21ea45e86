#include "gis/mesh/quantized_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <GeographicLib/Geocentric.hpp>

#include "core/support/error.h"

namespace arete {
namespace {

using Vector = std::array<double, 3>;

constexpr std::uint8_t normals_extension = 1;
constexpr std::size_t most_short_vertices = 65536;

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector& a) { return std::sqrt(dot(a, a)); }

Vector geocentric(double longitude, double latitude, double height_m) {
  Vector place;
  GeographicLib::Geocentric::WGS84().Forward(latitude, longitude, height_m, place[0], place[1], place[2]);
  return place;
}

Vector in_radii(const Vector& place) {
  const double equator = GeographicLib::Constants::WGS84_a(), pole = equator * (1 - GeographicLib::Constants::WGS84_f());
  return {place[0] / equator, place[1] / equator, place[2] / pole};
}

/// How far along `direction` a point must lie so that it is below the horizon only where `place` is, in radii; infinite where no point is.
/// Source: Cesium, "Computing the horizon occlusion point" (2013/05/09).
double horizon_distance(const Vector& place, const Vector& direction) {
  const Vector point = in_radii(place);
  const double distance = length(point), above = std::max(1.0, distance);
  const double cos_alpha = dot(point, direction) / distance, sin_alpha = std::sqrt(std::max(0.0, 1 - cos_alpha * cos_alpha));
  const double cos_beta = 1 / above, sin_beta = std::sqrt(above * above - 1) * cos_beta;
  const double cosine = cos_alpha * cos_beta - sin_alpha * sin_beta;
  return cosine > 0 ? 1 / cosine : std::numeric_limits<double>::infinity();
}

/// Bytes that are appended to.
class Writer {
 public:
  template <class T>
  void put(T value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof(T));
    std::memcpy(bytes.data() + at, &value, sizeof(T));
  }
  void align(std::size_t to) {
    while (bytes.size() % to != 0) bytes.push_back(std::byte{0});
  }
  std::vector<std::byte> bytes;
};

void put_differences(Writer& to, const std::vector<std::uint16_t>& values) {
  int before = 0;
  for (const std::uint16_t value : values) {
    const int difference = value - before;
    to.put(static_cast<std::uint16_t>(difference < 0 ? -2 * difference - 1 : 2 * difference));
    before = value;
  }
}

template <class Index>
void put_indices(Writer& to, const QuantizedMesh& mesh) {
  to.align(sizeof(Index));
  to.put(static_cast<std::uint32_t>(mesh.triangles.size() / 3));
  std::uint32_t highest = 0;
  for (const std::uint32_t vertex : mesh.triangles) {
    if (vertex > highest || vertex >= mesh.u.size())
      throw Error(ErrorKind::format, "a tile of quantized-mesh needs its vertices in the order in which triangles first name them");
    if (highest - vertex > std::numeric_limits<Index>::max())
      throw Error(ErrorKind::format, "a tile of quantized-mesh with exactly 65536 vertices cannot name its first one again after its last");
    to.put(static_cast<Index>(highest - vertex));
    if (vertex == highest) ++highest;
  }
  for (const auto* side : {&mesh.west, &mesh.south, &mesh.east, &mesh.north}) {
    to.put(static_cast<std::uint32_t>(side->size()));
    for (const std::uint32_t vertex : *side) to.put(static_cast<Index>(vertex));
  }
}

/// Bytes that are read from their start; never beyond their end.
class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  template <class T>
  T take(const char* what) {
    need(sizeof(T), what);
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  /// Throws where not so many bytes are left.
  void need(std::uint64_t count, const char* what) const {
    if (count > bytes_.size() - at_)
      fail(std::string("ends within its ") + what + ": expected " + std::to_string(count) + " bytes more at byte " + std::to_string(at_) + ", found " +
           std::to_string(bytes_.size() - at_));
  }
  void align(std::size_t to) {
    const std::size_t padding = (to - at_ % to) % to;
    need(padding, "padding");
    at_ += padding;
  }
  void skip(std::uint64_t count, const char* what) {
    need(count, what);
    at_ += count;
  }
  bool at_end() const { return at_ == bytes_.size(); }
  std::size_t left() const { return bytes_.size() - at_; }
  [[noreturn]] void fail(const std::string& what) const { throw Error(ErrorKind::input, "'" + name_ + "' is a damaged tile of quantized-mesh: it " + what); }

 private:
  std::span<const std::byte> bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
};

Vector take_vector(Reader& from) {
  Vector vector;
  for (double& number : vector) number = from.take<double>("header");
  return vector;
}

std::vector<std::uint16_t> take_differences(Reader& from, std::uint32_t count) {
  std::vector<std::uint16_t> values(count);
  int value = 0;
  for (std::uint16_t& to : values) {
    const int code = from.take<std::uint16_t>("vertices");
    value += (code >> 1) ^ -(code & 1);
    if (value < 0 || value > quantized_end) from.fail("has a coordinate of " + std::to_string(value) + ", expected 0 to 32767");
    to = static_cast<std::uint16_t>(value);
  }
  return values;
}

template <class Index>
void take_indices(Reader& from, QuantizedMesh& mesh) {
  from.align(sizeof(Index));
  const std::uint32_t vertices = static_cast<std::uint32_t>(mesh.u.size());
  const std::uint64_t corners = 3 * static_cast<std::uint64_t>(from.take<std::uint32_t>("indices"));
  from.need(corners * sizeof(Index), "indices");
  mesh.triangles.resize(corners);
  std::uint32_t highest = 0;
  for (std::uint32_t& vertex : mesh.triangles) {
    const std::uint32_t code = from.take<Index>("indices");
    if (code > highest || highest - code >= vertices)
      from.fail("has a triangle with vertex " + std::to_string(static_cast<std::int64_t>(highest) - code) + ", its vertices are " + std::to_string(vertices));
    vertex = highest - code;
    if (code == 0) ++highest;
  }
  for (auto* side : {&mesh.west, &mesh.south, &mesh.east, &mesh.north}) {
    const std::uint32_t count = from.take<std::uint32_t>("sides");
    from.need(static_cast<std::uint64_t>(count) * sizeof(Index), "sides");
    side->resize(count);
    for (std::uint32_t& vertex : *side) {
      vertex = from.take<Index>("sides");
      if (vertex >= vertices) from.fail("names vertex " + std::to_string(vertex) + " on a side, its vertices are " + std::to_string(vertices));
    }
  }
}

void take_extensions(Reader& from, QuantizedMesh& mesh) {
  while (!from.at_end()) {
    const std::uint8_t id = from.take<std::uint8_t>("extensions");
    const std::uint32_t size = from.take<std::uint32_t>("extensions");
    from.need(size, "extensions");
    if (id != normals_extension) {
      from.skip(size, "extensions");
      continue;
    }
    if (size != 2 * mesh.u.size()) from.fail("has normals of " + std::to_string(size) + " bytes, expected " + std::to_string(2 * mesh.u.size()));
    mesh.normals.resize(size);
    for (std::uint8_t& byte : mesh.normals) byte = from.take<std::uint8_t>("normals");
  }
}

}  // namespace

TileRectangle terrain_tile_rectangle(int level, std::int64_t x, std::int64_t y) {
  const double side = std::ldexp(180.0, -level);
  return {-180 + side * static_cast<double>(x), -90 + side * static_cast<double>(y), -180 + side * static_cast<double>(x + 1),
          -90 + side * static_cast<double>(y + 1)};
}

void sort_by_use(QuantizedMesh& mesh) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.u.size(), unused);
  QuantizedMesh sorted = mesh;
  for (auto* values : {&sorted.u, &sorted.v, &sorted.height}) values->clear();
  for (auto* side : {&sorted.west, &sorted.south, &sorted.east, &sorted.north}) side->clear();
  sorted.normals.clear();
  for (std::uint32_t& vertex : sorted.triangles) {
    const std::uint32_t old = vertex;
    if (number[old] == unused) {
      number[old] = static_cast<std::uint32_t>(sorted.u.size());
      sorted.u.push_back(mesh.u[old]), sorted.v.push_back(mesh.v[old]), sorted.height.push_back(mesh.height[old]);
      if (!mesh.normals.empty()) sorted.normals.insert(sorted.normals.end(), {mesh.normals[2 * old], mesh.normals[2 * old + 1]});
    }
    vertex = number[old];
  }
  mesh = std::move(sorted);
}

void place_quantized_mesh(QuantizedMesh& mesh, const TileRectangle& r) {
  std::vector<Vector> places(mesh.u.size());
  Vector low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = geocentric(r.west + (r.east - r.west) * mesh.u[i] / quantized_end, r.south + (r.north - r.south) * mesh.v[i] / quantized_end, mesh.height_m(i));
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], places[i][k]), high[k] = std::max(high[k], places[i][k]);
  }
  if (places.empty()) low = high = geocentric((r.west + r.east) / 2, (r.south + r.north) / 2, 0);
  for (std::size_t k = 0; k < 3; ++k) mesh.sphere[k] = (low[k] + high[k]) / 2;
  mesh.centre = mesh.sphere;
  mesh.radius_m = 0;
  const Vector scaled = in_radii(mesh.sphere);
  const double distance = length(scaled);
  // The middle of half the globe is near the centre of the Earth; then the direction is that of the tile's middle.
  Vector direction = distance > 0.01 ? scaled : in_radii(geocentric((r.west + r.east) / 2, (r.south + r.north) / 2, 0));
  const double norm = length(direction);
  for (double& part : direction) part /= norm;
  double reach = 1;
  for (const Vector& place : places) {
    mesh.radius_m = std::max(mesh.radius_m, length(place - mesh.sphere));
    reach = std::max(reach, horizon_distance(place, direction));
  }
  // A tile that spans a quarter of the globe has no such point: one far out is the nearest to it.
  constexpr double far = 1e6;
  for (std::size_t k = 0; k < 3; ++k) mesh.horizon[k] = direction[k] * std::min(reach, far);

  for (auto* side : {&mesh.west, &mesh.south, &mesh.east, &mesh.north}) side->clear();
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    if (mesh.u[i] == 0) mesh.west.push_back(i);
    if (mesh.v[i] == 0) mesh.south.push_back(i);
    if (mesh.u[i] == quantized_end) mesh.east.push_back(i);
    if (mesh.v[i] == quantized_end) mesh.north.push_back(i);
  }
  const auto along = [&](const std::vector<std::uint16_t>& place) {
    return [&place](std::uint32_t a, std::uint32_t b) { return place[a] < place[b]; };
  };
  for (auto* side : {&mesh.west, &mesh.east}) std::stable_sort(side->begin(), side->end(), along(mesh.v));
  for (auto* side : {&mesh.south, &mesh.north}) std::stable_sort(side->begin(), side->end(), along(mesh.u));
}

std::vector<std::byte> encode_quantized_mesh(const QuantizedMesh& mesh) {
  Writer to;
  for (const double number : mesh.centre) to.put(number);
  to.put(mesh.minimum_m);
  to.put(mesh.maximum_m);
  for (const double number : mesh.sphere) to.put(number);
  to.put(mesh.radius_m);
  for (const double number : mesh.horizon) to.put(number);
  to.put(static_cast<std::uint32_t>(mesh.u.size()));
  for (const auto* values : {&mesh.u, &mesh.v, &mesh.height}) put_differences(to, *values);
  if (mesh.u.size() > most_short_vertices) put_indices<std::uint32_t>(to, mesh);
  else put_indices<std::uint16_t>(to, mesh);
  if (!mesh.normals.empty()) {
    to.put(normals_extension);
    to.put(static_cast<std::uint32_t>(mesh.normals.size()));
    for (const std::uint8_t byte : mesh.normals) to.put(byte);
  }
  return std::move(to.bytes);
}

QuantizedMesh decode_quantized_mesh(std::span<const std::byte> bytes, const std::string& name) {
  Reader from(bytes, name);
  QuantizedMesh mesh;
  mesh.centre = take_vector(from);
  mesh.minimum_m = from.take<float>("header");
  mesh.maximum_m = from.take<float>("header");
  mesh.sphere = take_vector(from);
  mesh.radius_m = from.take<double>("header");
  mesh.horizon = take_vector(from);
  if (!std::isfinite(mesh.minimum_m) || !std::isfinite(mesh.maximum_m) || mesh.maximum_m < mesh.minimum_m) from.fail("has no range of heights");
  const std::uint32_t vertices = from.take<std::uint32_t>("vertices");
  from.need(6 * static_cast<std::uint64_t>(vertices), "vertices");
  mesh.u = take_differences(from, vertices);
  mesh.v = take_differences(from, vertices);
  mesh.height = take_differences(from, vertices);
  if (vertices > most_short_vertices) take_indices<std::uint32_t>(from, mesh);
  else take_indices<std::uint16_t>(from, mesh);
  take_extensions(from, mesh);
  return mesh;
}

std::array<std::uint8_t, 2> oct_encode(const Vector& n) {
  const double sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  double x = n[0] / sum, y = n[1] / sum;
  if (n[2] < 0) {
    const double folded = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const auto byte = [](double part) { return static_cast<std::uint8_t>(std::lround((std::clamp(part, -1.0, 1.0) * 0.5 + 0.5) * 255)); };
  return {byte(x), byte(y)};
}

Vector oct_decode(std::uint8_t x, std::uint8_t y) {
  Vector n{x / 255.0 * 2 - 1, y / 255.0 * 2 - 1, 0};
  n[2] = 1 - (std::abs(n[0]) + std::abs(n[1]));
  if (n[2] < 0) {
    const double old = n[0];
    n[0] = (1 - std::abs(n[1])) * (old < 0 ? -1 : 1);
    n[1] = (1 - std::abs(old)) * (n[1] < 0 ? -1 : 1);
  }
  const double norm = length(n);
  return {n[0] / norm, n[1] / norm, n[2] / norm};
}

}  // namespace arete
