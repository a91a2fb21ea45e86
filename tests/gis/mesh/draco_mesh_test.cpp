#include "gis/mesh/draco_mesh.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace arete {
namespace {

/// A grid of places that are multiples of the step 2^-10, to both ends of the reach.
MeshArrays sample(int side) {
  MeshArrays arrays;
  std::uint32_t state = 1;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      std::array<float, 3> p;
      for (float& c : p) {
        state = state * 1664525u + 1013904223u;
        c = static_cast<float>(static_cast<std::int32_t>(state >> 9) - (1 << 22)) / 1024.0f;
      }
      arrays.positions.push_back(p);
    }
  arrays.positions.front() = {-4096, -4096, -4096};
  arrays.positions.back() = {4096 - 1.0f / 1024, 4096 - 1.0f / 1024, 4096 - 1.0f / 1024};
  const auto n = static_cast<std::uint32_t>(side);
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t i = y * n + x;
      arrays.indices.insert(arrays.indices.end(), {i, i + 1, i + n, i + 1, i + n + 1, i + n});
    }
  return arrays;
}

using Triangle = std::array<std::array<float, 3>, 3>;
std::vector<Triangle> triangles(const MeshArrays& arrays) {
  std::vector<Triangle> all;
  for (std::size_t i = 0; i < arrays.indices.size(); i += 3) {
    Triangle t{arrays.positions.at(arrays.indices[i]), arrays.positions.at(arrays.indices[i + 1]), arrays.positions.at(arrays.indices[i + 2])};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    all.push_back(t);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(DracoMesh, PositionsOnTheGridComeBackExactly) {
  const MeshArrays arrays = sample(40);
  const DracoMesh draco = encode_draco(arrays, 4096);
  EXPECT_EQ(draco.vertices, 1600);
  EXPECT_EQ(draco.triangles, 39 * 39 * 2);
  const MeshArrays decoded = decode_draco(draco.bytes, draco.position_id, "a test");
  EXPECT_EQ(std::ssize(decoded.positions), draco.vertices);
  EXPECT_EQ(triangles(decoded), triangles(arrays));
}

TEST(DracoMesh, HoldsNormalsAndTextureBesidePositions) {
  MeshArrays arrays = sample(10);
  arrays.normals.assign(100, {0, 1, 0});
  for (int i = 0; i < 100; ++i) arrays.texture.push_back({static_cast<float>(i) / 100, 0.5f});
  const DracoMesh draco = encode_draco(arrays, 4096);
  EXPECT_EQ(triangles(decode_draco(draco.bytes, draco.position_id, "a test")), triangles(arrays));
  EXPECT_THROW(decode_draco(draco.bytes, 17, "a test"), Error);
}

// Three triangles at one edge: no manifold, Draco cuts it.
TEST(DracoMesh, HoldsMeshesThatAreNoManifold) {
  MeshArrays arrays;
  arrays.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  arrays.indices = {0, 1, 2, 1, 0, 3, 0, 1, 4};
  const DracoMesh draco = encode_draco(arrays, 16);
  EXPECT_EQ(draco.triangles, 3);
  const MeshArrays decoded = decode_draco(draco.bytes, draco.position_id, "a test");
  EXPECT_EQ(std::ssize(decoded.positions), draco.vertices);
  EXPECT_EQ(triangles(decoded), triangles(arrays));
}

TEST(DracoMesh, RefusesOrReadsAnyBytes) {
  const DracoMesh draco = encode_draco(sample(6), 4096);
  for (std::size_t length = 0; length < draco.bytes.size(); ++length)
    EXPECT_THROW(decode_draco(std::span(draco.bytes).first(length), draco.position_id, "a test"), Error) << length;
  for (std::size_t i = 0; i < draco.bytes.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::vector<std::byte> bad = draco.bytes;
      bad[i] ^= std::byte{static_cast<unsigned char>(1 << bit)};
      try {
        const MeshArrays decoded = decode_draco(bad, draco.position_id, "a test");
        for (const std::uint32_t index : decoded.indices) ASSERT_LT(index, decoded.positions.size());
      } catch (const Error&) {
      }
    }
}

TEST(DracoMesh, AllocatesNothingForCountsThatBytesCannotHold) {
  DracoMesh draco = encode_draco(sample(6), 4096);
  // Behind the header of 11 bytes and the kind of traversal: the vertices as a varint, here 2^32 - 1.
  std::vector<std::byte> bad(draco.bytes.begin(), draco.bytes.begin() + 12);
  for (const int byte : {0xff, 0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0xff, 0x0f, 1, 1, 1, 1, 1, 1, 1, 1}) bad.push_back(std::byte{static_cast<unsigned char>(byte)});
  try {
    decode_draco(bad, 0, "a test");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("4294967295"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace arete
