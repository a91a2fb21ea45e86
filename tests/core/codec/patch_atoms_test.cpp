#include "core/codec/patch_atoms.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/random.h"

namespace arete {
namespace {

// Waves under the disc, in steps of 2^(j mod 12).
PatchAtoms waves(int side, std::int64_t count) {
  PatchAtoms atoms{side, count, std::vector<std::int16_t>(static_cast<std::size_t>(count * side * side))};
  for (std::int64_t j = 0; j < count; ++j)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (inside_disc(side, x, y))
          atoms.samples[static_cast<std::size_t>((j * side + y) * side + x)] = static_cast<std::int16_t>(
              static_cast<int>(std::lround(3000 * std::sin(0.3 * x * static_cast<double>(j + 1) + 0.2 * y))) / (1 << j % 12) * (1 << j % 12));
  return atoms;
}

TEST(PatchAtoms, ComeBackAsTheyWere) {
  for (int side : {4, 14, 64}) {
    const PatchAtoms atoms = waves(side, 24);
    const std::vector<std::byte> bytes = encode_atoms(atoms);
    EXPECT_EQ(decode_atoms(bytes, side, 24).samples, atoms.samples) << side;
    EXPECT_GE(static_cast<std::int64_t>(bytes.size()), least_atom_bytes(side, 24));
  }
}

TEST(PatchAtoms, ExtremesComeBack) {
  PatchAtoms atoms = waves(6, 3);
  for (std::size_t i = 0; i < atoms.samples.size(); ++i)
    if (inside_disc(6, static_cast<int>(i % 6), static_cast<int>(i / 6 % 6))) atoms.samples[i] = hash_position(1, i) % 2 ? 32767 : -32767;
  EXPECT_EQ(decode_atoms(encode_atoms(atoms), 6, 3).samples, atoms.samples);
}

TEST(PatchAtoms, CoarserSamplesTakeFewerBytes) {
  PatchAtoms atoms = waves(14, 60);
  const std::size_t fine = encode_atoms(atoms).size();
  for (std::int16_t& sample : atoms.samples) sample = static_cast<std::int16_t>(sample / 1024 * 1024);
  EXPECT_LT(encode_atoms(atoms).size(), fine / 2);
}

TEST(PatchAtoms, NoAtoms) {
  const PatchAtoms none{14, 0, {}};
  EXPECT_EQ(decode_atoms(encode_atoms(none), 14, 0).count, 0);
}

TEST(PatchAtoms, AnyBytesGiveAtoms) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::vector<std::byte> bytes(200);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = seed == 0 ? std::byte{0xff} : static_cast<std::byte>(hash_position(seed, i));
    const PatchAtoms atoms = decode_atoms(bytes, 16, 20);
    for (std::size_t i = 0; i < atoms.samples.size(); ++i)
      if (!inside_disc(16, static_cast<int>(i % 16), static_cast<int>(i / 16 % 16))) {
        ASSERT_EQ(atoms.samples[i], 0);
      }
  }
}

}  // namespace
}  // namespace arete
