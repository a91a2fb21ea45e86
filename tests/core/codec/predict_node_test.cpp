#include "core/codec/predict_node.h"

#include <gtest/gtest.h>

#include "tests/core/codec/predict_fixture.h"

namespace arete {
namespace {

// One node in the middle of a level, given level 1 exactly.
struct Scene {
  Raster<std::int32_t> terrain = fractal_terrain(96, 80, 2000);
  Raster<std::uint8_t> voids = ragged_mask(96, 80);
  Raster<std::int32_t> coarse{48, 40};
  Raster<std::uint8_t> coarse_voids{48, 40};
  PredictParameters file;
  LevelParameters level = default_level_parameters();
  Window cells{32, 32, 32, 32};
  bool any_void;

  explicit Scene(bool with_voids, std::int32_t step = 1) : any_void(with_voids) {
    for (std::int64_t y = 0; y < 40; ++y)
      for (std::int64_t x = 0; x < 48; ++x) {
        coarse(x, y) = terrain(2 * x, 2 * y);
        coarse_voids(x, y) = voids(2 * x, 2 * y);
      }
    file.lowest = -100;
    file.highest = 2100;
    level.step = step;
  }
  LevelView view() const {
    return {coarse.view(), any_void ? coarse_voids.view() : RasterView<const std::uint8_t>{}, 0, 0, coarse.size()};
  }
  RasterView<const std::uint8_t> mask() const { return any_void ? voids.view().sub(cells) : RasterView<const std::uint8_t>{}; }
  std::vector<std::byte> encode(Raster<std::int32_t>& decoded) const { return encode(view(), decoded); }
  std::vector<std::byte> encode(const LevelView& from, Raster<std::int32_t>& decoded) const {
    return encode_node(from, cells, file, level, {terrain.view().sub(cells), mask()}, decoded.view());
  }
  void decode(std::span<const std::byte> bytes, Raster<std::int32_t>& decoded) const {
    decode_node(view(), cells, file, level, bytes, mask(), decoded.view());
  }
};

bool same(const Raster<std::int32_t>& a, const Raster<std::int32_t>& b) { return largest_difference(a.view(), b.view()) == 0; }

TEST(PredictNode, DecodesToWhatTheEncoderSaw) {
  for (bool voids : {false, true})
    for (std::int32_t step : {1, 7, 64}) {
      const Scene scene(voids, step);
      Raster<std::int32_t> encoded(32, 32), decoded(32, 32);
      scene.decode(scene.encode(encoded), decoded);
      EXPECT_TRUE(same(encoded, decoded)) << voids << " " << step;
      EXPECT_LE(largest_difference(decoded.view(), scene.terrain.view().sub(scene.cells), scene.mask()), step / 2);
    }
}

TEST(PredictNode, AnEmptyStreamIsAllZeros) {
  Scene scene(false, 1 << 20);
  Raster<std::int32_t> encoded(32, 32), decoded(32, 32);
  EXPECT_TRUE(scene.encode(encoded).empty());
  scene.decode({}, decoded);
  EXPECT_TRUE(same(encoded, decoded));
}

TEST(PredictNode, LooksNoFurtherThanTheMargin) {
  for (bool voids : {false, true}) {
    const Scene scene(voids);
    Scene part(voids);
    Raster<std::int32_t> a(32, 32), b(32, 32);
    for (std::int64_t y = 0; y < 40; ++y)
      for (std::int64_t x = 0; x < 48; ++x) {
        if (x >= 16 - lattice_margin && x < 32 + lattice_margin && y >= 16 - lattice_margin && y < 32 + lattice_margin) continue;
        part.coarse(x, y) = 12345;
        part.coarse_voids(x, y) = !part.coarse_voids(x, y);
      }
    EXPECT_EQ(part.encode(b), scene.encode(a));
    EXPECT_TRUE(same(a, b));
  }
}

TEST(PredictNode, AWindowOfTheCoarseLevelIsEnough) {
  const Scene scene(true);
  Raster<std::int32_t> a(32, 32), b(32, 32);
  const Window w{16 - lattice_margin, 16 - lattice_margin, 16 + 2 * lattice_margin, 16 + 2 * lattice_margin};
  const LevelView window{scene.view().values.sub(w), scene.view().voids.sub(w), w.x, w.y, scene.coarse.size()};
  EXPECT_EQ(scene.encode(window, b), scene.encode(a));
  EXPECT_TRUE(same(a, b));
}

TEST(PredictNode, APlaneCostsNothing) {
  Scene scene(false);
  for (std::int64_t y = 0; y < 80; ++y)
    for (std::int64_t x = 0; x < 96; ++x) scene.terrain(x, y) = static_cast<std::int32_t>(3 * x + 5 * y);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 48; ++x) scene.coarse(x, y) = scene.terrain(2 * x, 2 * y);
  Raster<std::int32_t> decoded(32, 32);
  EXPECT_TRUE(scene.encode(decoded).empty());
}

TEST(PredictNode, HostileBytesGiveValuesInRange) {
  for (bool voids : {false, true}) {
    Scene scene(voids, 5);
    Raster<std::int32_t> decoded(32, 32);
    const auto bytes = scene.encode(decoded);
    const auto check = [&](std::span<const std::byte> hostile) {
      scene.decode(hostile, decoded);
      for (std::int64_t i = 0; i < decoded.size().cells(); ++i) {
        const std::int64_t x = i % 32, y = i / 32;
        if (x % 2 == 0 && y % 2 == 0) continue;  // given, not decoded
        ASSERT_GE(decoded.data()[i], scene.file.lowest);
        ASSERT_LE(decoded.data()[i], scene.file.highest);
      }
    };
    for (std::size_t length = 0; length < bytes.size(); ++length) check({bytes.data(), length});
    for (std::uint64_t i = 0; i < 300; ++i) {
      auto flipped = bytes;
      flipped[hash_position(4, i, 0) % flipped.size()] ^= static_cast<std::byte>(1 + hash_position(4, i, 1) % 255);
      check(flipped);
    }
    for (std::uint64_t i = 0; i < 100; ++i) {
      std::vector<std::byte> noise(200);
      for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = static_cast<std::byte>(hash_position(6, i, k));
      check(noise);
    }
    check(std::vector<std::byte>(5000, std::byte{255}));
  }
}

// The same with the arithmetic of wide values and all parameters at their limits.
TEST(PredictNode, HostileBytesUnderExtremeParameters) {
  Scene scene(true, 1 << 24);
  scene.file.lowest = INT32_MIN;
  scene.file.highest = INT32_MAX;
  for (std::int64_t i = 0; i < scene.coarse.size().cells(); ++i)
    scene.coarse.data()[i] = static_cast<std::int32_t>(hash_position(7, static_cast<std::uint64_t>(i)));
  for (PhaseParameters& phase : scene.level.phases) {
    phase.taps = {5119, -3071};
    phase.recursion = {-64, 64, -64, 64};
    phase.activity.fill(255);
    phase.noise = 119;
  }
  Raster<std::int32_t> decoded(32, 32);
  for (std::uint64_t i = 0; i < 100; ++i) {
    std::vector<std::byte> noise(3000);
    for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = static_cast<std::byte>(hash_position(8, i, k));
    scene.decode(noise, decoded);
  }
  scene.file.lowest = -65536;
  scene.file.highest = 65536;
  for (std::int64_t i = 0; i < scene.coarse.size().cells(); ++i)
    scene.coarse.data()[i] = (hash_position(7, static_cast<std::uint64_t>(i)) & 1U) != 0 ? 65536 : -65536;
  scene.decode(std::vector<std::byte>(3000, std::byte{0x5a}), decoded);
}

}  // namespace
}  // namespace arete
