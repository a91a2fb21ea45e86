#include "gis/mesh/quantized_mesh.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

/// A fan of triangles about a vertex in the middle.
QuantizedMesh make_fan(std::uint32_t rim) {
  QuantizedMesh mesh;
  mesh.minimum_m = 100, mesh.maximum_m = 100 + 32767.0f / 1024;
  mesh.u = {16000}, mesh.v = {16000}, mesh.height = {32767};
  for (std::uint32_t i = 0; i < rim; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / rim;
    mesh.u.push_back(static_cast<std::uint16_t>(std::clamp(16383.5 + 30000 * std::cos(angle), 0.0, 32767.0)));
    mesh.v.push_back(static_cast<std::uint16_t>(std::clamp(16383.5 + 30000 * std::sin(angle), 0.0, 32767.0)));
    mesh.height.push_back(static_cast<std::uint16_t>(hash_position(1, i) % 32768));
  }
  for (std::uint32_t i = 0; i < rim; ++i) mesh.triangles.insert(mesh.triangles.end(), {0, 1 + i, 1 + (i + 1) % rim});
  sort_by_use(mesh);
  place_quantized_mesh(mesh, terrain_tile_rectangle(10, 1080, 700));
  return mesh;
}

void expect_equal(const QuantizedMesh& a, const QuantizedMesh& b) {
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.minimum_m, b.minimum_m);
  EXPECT_EQ(a.maximum_m, b.maximum_m);
  EXPECT_EQ(a.sphere, b.sphere);
  EXPECT_EQ(a.radius_m, b.radius_m);
  EXPECT_EQ(a.horizon, b.horizon);
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.west, b.west);
  EXPECT_EQ(a.south, b.south);
  EXPECT_EQ(a.east, b.east);
  EXPECT_EQ(a.north, b.north);
  EXPECT_EQ(a.normals, b.normals);
}

TEST(QuantizedMesh, ComesBackAsItWas) {
  for (const std::uint32_t rim : {4u, 5u, 300u, 65534u, 65536u, 70000u}) {
    QuantizedMesh mesh = make_fan(rim);
    expect_equal(decode_quantized_mesh(encode_quantized_mesh(mesh), "fan"), mesh);
    mesh.normals.assign(2 * mesh.u.size(), 77);
    expect_equal(decode_quantized_mesh(encode_quantized_mesh(mesh), "fan"), mesh);
  }
}

// One triangle, written by hand from the specification.
TEST(QuantizedMesh, BytesAreThoseOfTheSpecification) {
  QuantizedMesh mesh;
  mesh.minimum_m = 1, mesh.maximum_m = 2;
  mesh.u = {0, 32767, 0}, mesh.v = {0, 0, 32767}, mesh.height = {5, 4, 32767};
  mesh.triangles = {0, 1, 2};
  mesh.west = {0, 2}, mesh.south = {0, 1}, mesh.east = {1}, mesh.north = {2};
  const std::vector<std::byte> bytes = encode_quantized_mesh(mesh);
  // u: 0, +32767, -32767; v: 0, 0, +32767; height: +5, -1, +32763; codes are 2 d, or -2 d - 1.
  const std::vector<std::uint16_t> expected = {3, 0, 0, 65534, 65533, 0, 0, 65534, 10, 1, 65526, 1, 0, 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 1, 1, 0, 1, 1, 0, 2};
  ASSERT_EQ(bytes.size(), 88 + 2 * expected.size());
  std::vector<std::uint16_t> found(expected.size());
  std::memcpy(found.data(), bytes.data() + 88, 2 * found.size());
  EXPECT_EQ(found, expected);
}

TEST(QuantizedMesh, EveryTruncationIsRefused) {
  QuantizedMesh mesh = make_fan(7);
  mesh.normals.assign(2 * mesh.u.size(), 77);
  const std::vector<std::byte> bytes = encode_quantized_mesh(mesh);
  const std::size_t without_normals = bytes.size() - 5 - mesh.normals.size();  // extensions may be missing
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    if (length == without_normals) continue;
    EXPECT_THROW(decode_quantized_mesh({bytes.data(), length}, "cut"), Error) << length;
  }
}

TEST(QuantizedMesh, ChangedBytesNeverCrashAndIndicesStayInside) {
  const std::vector<std::byte> bytes = encode_quantized_mesh(make_fan(7));
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    std::vector<std::byte> changed = bytes;
    for (int k = 0; k < 3; ++k) changed[hash_position(seed, k) % changed.size()] = static_cast<std::byte>(hash_position(seed, k, 1));
    try {
      const QuantizedMesh mesh = decode_quantized_mesh(changed, "changed");
      for (const std::uint32_t vertex : mesh.triangles) ASSERT_LT(vertex, mesh.u.size());
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
}

TEST(QuantizedMesh, CountsBeyondTheFileAllocateNothing) {
  std::vector<std::byte> bytes = encode_quantized_mesh(make_fan(7));
  std::memset(bytes.data() + 88, 0xff, 4);
  EXPECT_THROW(decode_quantized_mesh(bytes, "huge"), Error);
}

TEST(QuantizedMesh, VerticesOutOfTheOrderOfUseAreRefused) {
  QuantizedMesh mesh = make_fan(5);
  std::swap(mesh.triangles[0], mesh.triangles[1]);
  EXPECT_THROW(encode_quantized_mesh(mesh), Error);
}

// Codes of 16 bits end at 65535 below the highest.
TEST(QuantizedMesh, AVertexThatNoCodeReachesIsRefused) { EXPECT_THROW(encode_quantized_mesh(make_fan(65535)), Error); }

TEST(QuantizedMesh, OctNormalsAreWithinADegree) {
  for (std::uint64_t i = 0; i < 5000; ++i) {
    std::array<double, 3> n{uniform_at(3, i, 0) - 0.5, uniform_at(3, i, 1) - 0.5, uniform_at(3, i, 2) - 0.5};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (double& part : n) part /= length;
    const auto [x, y] = oct_encode(n);
    const std::array<double, 3> back = oct_decode(x, y);
    // The survey gives 0.95 degrees for 16 bits at most.
    EXPECT_GT(n[0] * back[0] + n[1] * back[1] + n[2] * back[2], std::cos(0.0168)) << i;
  }
}

}  // namespace
}  // namespace arete
