#include "core/codec/subband_coder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/codec/subband_models.h"
#include "core/codec/trellis.h"
#include "core/support/random.h"

namespace arete {
namespace {

// Coefficients that the trellis allows, of a magnitude about `scale` where the flags are on.
NodeCoefficients random_node(int width, int height, double scale, std::uint64_t seed) {
  NodeCoefficients node;
  for (std::size_t b = 0; b < band_count; ++b) {
    CoefficientBlock& block = node.bands[b] = CoefficientBlock(width, height);
    int state = 0;
    for (int y = 0; y < height; ++y) {
      for (int s = 0; y % CoefficientBlock::square == 0 && s < block.squares_wide(); ++s)
        block.flags(y / CoefficientBlock::square)[s] = uniform_at(seed, b, static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(s)) < 0.7;
      for (int x = 0; x < width; ++x) {
        if (!block.flags(y / CoefficientBlock::square)[x / CoefficientBlock::square]) continue;
        const double u = uniform_at(seed + 1, b, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
        const auto k = static_cast<std::int32_t>(-scale * std::log(1 - u));
        const std::int32_t point = lattice_point(k, quantiser_of(state));
        block.set(x, y, uniform_at(seed + 2, b, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) < 0.5 ? -point : point);
        state = trellis_next[static_cast<std::size_t>(state)][k & 1];
      }
    }
  }
  return node;
}

NodeCoefficients decode(const std::vector<std::byte>& bytes, const ParentView& parent, int width, int height) {
  NodeCoefficients node;
  for (CoefficientBlock& block : node.bands) block = CoefficientBlock(width, height);
  SubbandModels models = initial_subband_models();
  decode_subbands(bytes, parent, models, node);
  return node;
}

std::vector<std::byte> encode(const NodeCoefficients& node, const ParentView& parent) {
  SubbandModels models = initial_subband_models();
  return encode_subbands(node, parent, models);
}

void expect_equal(const NodeCoefficients& a, const NodeCoefficients& b) {
  for (std::size_t i = 0; i < band_count; ++i)
    for (int y = 0; y < a.bands[i].height(); ++y)
      for (int x = 0; x < a.bands[i].width(); ++x) ASSERT_EQ(a.bands[i].row(y)[x], b.bands[i].row(y)[x]) << "band " << i << " at " << x << "," << y;
}

TEST(SubbandCoder, GivesBackEveryCoefficient) {
  for (double scale : {0.2, 1.0, 20.0, 100000.0}) {
    const NodeCoefficients parent = random_node(64, 64, scale, 7);
    const NodeCoefficients node = random_node(61, 40, scale, 3);
    for (const ParentView& view : {ParentView{}, ParentView{&parent, 32, 32}}) expect_equal(decode(encode(node, view), view, 61, 40), node);
  }
}

TEST(SubbandCoder, KeepsTheGreatestMagnitudes) {
  NodeCoefficients node = random_node(16, 16, 1, 5);
  for (CoefficientBlock& block : node.bands) {
    std::fill_n(block.flags(0), 2, std::uint8_t{0});
    std::fill_n(block.flags(1), 2, std::uint8_t{0});
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) block.set(x, y, 0);
    block.flags(0)[0] = 1;
    block.set(0, 0, coefficient_limit);  // the first state has the even multiples
  }
  expect_equal(decode(encode(node, {}), {}, 16, 16), node);
}

TEST(SubbandCoder, EmptyBlocksCostNothing) {
  NodeCoefficients node;
  const std::vector<std::byte> bytes = encode(node, {});
  EXPECT_LE(bytes.size(), 1U);
}

// Any bytes decode to something, within the limits that the header promises; the sanitizers watch.
TEST(SubbandCoder, AnyBytesDecode) {
  const NodeCoefficients parent = random_node(32, 32, 3, 9);
  const std::vector<std::byte> good = encode(random_node(32, 32, 3, 4), {&parent, 16, 0});
  for (std::uint64_t i = 0; i < 300; ++i) {
    std::vector<std::byte> bytes = good;
    bytes[hash_position(1, i) % bytes.size()] ^= static_cast<std::byte>(1 + hash_position(2, i) % 255);
    if (i % 3 == 0) bytes.resize(hash_position(3, i) % bytes.size());
    const NodeCoefficients node = decode(bytes, {&parent, 16, 0}, 32, 32);
    for (const CoefficientBlock& block : node.bands)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) ASSERT_LE(std::abs(static_cast<std::int64_t>(block.row(y)[x])), 8LL * coefficient_limit);
  }
}

}  // namespace
}  // namespace arete
