#include "core/codec/patch_discs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/support/random.h"

namespace arete {
namespace {

PatchParameters parameters(int atoms, int sparsity, const Size& size = {200, 150}) {
  PatchParameters p;
  p.grid = NodeGrid(size, 128);
  p.radius = 6;
  p.sparsity = sparsity;
  p.atoms = {12, atoms, std::vector<std::int16_t>(static_cast<std::size_t>(atoms * 144))};
  for (std::size_t i = 0; i < p.atoms.samples.size(); ++i)
    p.atoms.samples[i] = static_cast<std::int16_t>(3000 * std::sin(0.1 * static_cast<double>(i % 144) * static_cast<double>(i / 144 + 1)));
  return p;
}

// Discs with up to s terms, some without any.
DiscBlock some_discs(const PatchParameters& p, std::int64_t node_x, std::int64_t node_y, std::uint64_t seed, std::int32_t greatest) {
  DiscBlock block = blank_discs(p, node_x, node_y);
  for (std::int64_t i = 0; i < block.count(); ++i) {
    const auto at = static_cast<std::uint64_t>(i);
    block.means[at] = static_cast<std::int32_t>((uniform_at(seed, at) - 0.5) * 2 * greatest);
    const auto wanted = static_cast<int>(hash_position(seed, at, 1) % static_cast<std::uint64_t>(p.sparsity + 1));
    std::int64_t atom = -1;
    for (int t = 0; t < wanted; ++t) {
      const std::int64_t left = p.atoms.count - 1 - atom - (wanted - t - 1);
      if (left <= 0) break;
      atom += 1 + static_cast<std::int64_t>(hash_position(seed, at, 2, static_cast<std::uint64_t>(t)) % static_cast<std::uint64_t>(left));
      auto k = static_cast<std::int32_t>((uniform_at(seed, at, 3, static_cast<std::uint64_t>(t)) - 0.5) * 2 * greatest);
      block.terms.push_back({static_cast<std::int32_t>(atom), k == 0 ? 1 : k});
    }
    block.first[at + 1] = static_cast<std::uint32_t>(block.terms.size());
  }
  return block;
}

void expect_same(const DiscBlock& a, const DiscBlock& b) {
  EXPECT_EQ(a.means, b.means);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.terms, b.terms);
}

TEST(PatchDiscs, ComeBackAsTheyWere) {
  for (const auto& [atoms, sparsity] : {std::pair{1, 1}, {5, 5}, {128, 1}, {128, 8}, {700, 64}}) {
    const PatchParameters p = parameters(atoms, sparsity);
    const AtomMoments moments = find_moments(p.atoms);
    for (std::int32_t greatest : {3, 100000, patch_value_limit}) {
      const DiscBlock block = some_discs(p, 1, 0, 7, greatest);
      DiscBlock decoded = blank_discs(p, 1, 0);
      decode_discs(p, moments, encode_discs(p, moments, block), decoded);
      expect_same(decoded, block);
    }
  }
}

TEST(PatchDiscs, NoReliefTakesNoBytes) {
  const PatchParameters p = parameters(16, 2);
  const AtomMoments moments = find_moments(p.atoms);
  EXPECT_TRUE(encode_discs(p, moments, blank_discs(p, 0, 0)).empty());
  DiscBlock decoded = blank_discs(p, 0, 0);
  decode_discs(p, moments, {}, decoded);
  expect_same(decoded, blank_discs(p, 0, 0));
}

TEST(PatchDiscs, EveryDiscLiesInOneBlock) {
  for (int radius : {2, 7, 32})
    for (std::int64_t cells : {1, 8, 33, 128, 129, 135, 257}) {
      const std::int64_t nodes = (cells + 127) / 128;
      std::int64_t next = 0;
      for (std::int64_t node = 0; node < nodes; ++node) {
        const PatchRange discs = discs_of_node(node, cells, 128, radius);
        EXPECT_EQ(discs.begin, next);
        EXPECT_GT(discs.end, discs.begin);
        for (std::int64_t k = discs.begin; k < discs.end; ++k) EXPECT_EQ(node_of_disc(k, cells, 128, radius), node) << cells << ' ' << radius;
        next = discs.end;
      }
      EXPECT_EQ(next, patches_along(make_patch_grid(2 * radius), cells));
    }
}

// Means on a plane go with the atoms that slope as it does; those tell in which order atoms are asked for.
TEST(PatchDiscs, MomentsFollowTheSlope) {
  PatchAtoms atoms{10, 3, std::vector<std::int16_t>(300)};
  for (int i = 0; i < 100; ++i)
    if (inside_disc(10, i % 10, i / 10)) {
      atoms.samples[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(100 * (2 * (i % 10) - 9));
      atoms.samples[static_cast<std::size_t>(100 + i)] = static_cast<std::int16_t>(100 * (2 * (i / 10) - 9));
    }
  const AtomMoments moments = find_moments(atoms);
  EXPECT_GT(moments.of[0][0], 1 << 12);
  EXPECT_EQ(moments.of[0][1], 0);
  EXPECT_EQ(moments.of[1][0], 0);
  EXPECT_EQ(moments.of[1][1], moments.of[0][0]);
  EXPECT_EQ(moments.of[2], (std::array<std::int32_t, 5>{}));
}

TEST(PatchDiscs, AnyBytesGiveDiscsWithinTheLimits) {
  const PatchParameters p = parameters(40, 5);
  const AtomMoments moments = find_moments(p.atoms);
  const std::vector<std::byte> good = encode_discs(p, moments, some_discs(p, 0, 1, 3, 500));
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::vector<std::byte> bytes = good;
    if (seed % 4 == 0) bytes.resize(hash_position(seed, 1) % bytes.size());
    if (seed % 4 == 1) bytes[hash_position(seed, 2) % bytes.size()] = static_cast<std::byte>(hash_position(seed, 3));
    if (seed % 4 == 2) bytes.assign(300, static_cast<std::byte>(seed));
    if (seed % 4 == 3)
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(hash_position(seed, 4, i));
    DiscBlock block = blank_discs(p, 0, 1);
    decode_discs(p, moments, bytes, block);
    ASSERT_EQ(block.first.size(), static_cast<std::size_t>(block.count()) + 1);
    for (const std::int32_t mean : block.means) ASSERT_LE(std::abs(mean), patch_value_limit);
    for (std::int64_t i = 0; i < block.count(); ++i) {
      ASSERT_LE(block.terms_of(i).size(), 5U);
      for (const DiscTerm& term : block.terms_of(i)) {
        ASSERT_TRUE(term.atom >= 0 && term.atom < 40);
        ASSERT_TRUE(term.coefficient != 0 && std::abs(term.coefficient) <= patch_value_limit);
      }
    }
  }
}

}  // namespace
}  // namespace arete
