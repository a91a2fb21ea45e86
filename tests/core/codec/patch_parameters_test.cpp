#include "core/codec/patch_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

Eigen::MatrixXf unit_atoms(int radius, int count) {
  const PatchGrid grid = make_patch_grid(2 * radius);
  Eigen::MatrixXf D(grid.samples(), count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < D.rows(); ++i)
      D(i, j) = grid.weights[static_cast<std::size_t>(i)] * static_cast<float>(uniform_at(1, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j)) - 0.5);
    D.col(j).normalize();
  }
  return D;
}

PatchParameters example() {
  PatchParameters p;
  p.grid = NodeGrid({100, 80}, 32);
  p.radius = 5;
  p.sparsity = 3;
  p.base = 1234.5F;
  p.mean_quantum = 0.75F;
  p.coefficient_quantum = 2.5F;
  p.atoms = round_atoms(unit_atoms(5, 20));
  return p;
}

PatchParameters parse(const std::vector<std::byte>& bytes) {
  return parse_patch_parameters(bytes, "example", example().grid, [](const std::string&) { return unit_atoms(5, 20); });
}

ErrorKind kind_of(const std::vector<std::byte>& bytes) {
  try {
    parse(bytes);
  } catch (const Error& error) {
    return error.kind();
  }
  return ErrorKind::usage;
}

TEST(PatchParameters, ComeBackAsTheyWere) {
  const PatchParameters p = example(), q = parse(serialise_patch_parameters(p));
  EXPECT_EQ(q.radius, p.radius);
  EXPECT_EQ(q.sparsity, p.sparsity);
  EXPECT_EQ(q.base, p.base);
  EXPECT_EQ(q.mean_quantum, p.mean_quantum);
  EXPECT_EQ(q.coefficient_quantum, p.coefficient_quantum);
  EXPECT_EQ(q.atoms.count, 20);
  EXPECT_EQ(q.atoms.samples, p.atoms.samples);
}

TEST(PatchParameters, ADictionaryIsNamedByItsDigest) {
  PatchParameters p = example();
  p.dictionary = "0123456789abcdef00112233445566ff";
  const std::vector<std::byte> bytes = serialise_patch_parameters(p);
  EXPECT_EQ(bytes.size(), 33U);
  std::string asked;
  const PatchParameters q = parse_patch_parameters(bytes, "example", p.grid, [&](const std::string& digest) {
    asked = digest;
    return unit_atoms(5, 20);
  });
  EXPECT_EQ(asked, p.dictionary);
  EXPECT_EQ(q.atoms.samples, p.atoms.samples);
  for (const DictionaryFinder& find : {DictionaryFinder{}, DictionaryFinder{[](const std::string&) { return unit_atoms(5, 19); }}}) {
    try {
      parse_patch_parameters(bytes, "example", p.grid, find);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
}

TEST(PatchParameters, RefusesWhatBreaksARule) {
  const std::vector<std::byte> good = serialise_patch_parameters(example());
  const auto with = [&](std::size_t at, std::vector<int> values) {
    std::vector<std::byte> bytes = good;
    for (std::size_t i = 0; i < values.size(); ++i) bytes[at + i] = static_cast<std::byte>(values[i]);
    return bytes;
  };
  EXPECT_EQ(kind_of(with(0, {1})), ErrorKind::damaged);                   // radius
  EXPECT_EQ(kind_of(with(0, {33})), ErrorKind::damaged);
  EXPECT_EQ(kind_of(with(1, {0})), ErrorKind::damaged);                   // sparsity
  EXPECT_EQ(kind_of(with(1, {65})), ErrorKind::damaged);
  EXPECT_EQ(kind_of(with(2, {255, 255})), ErrorKind::damaged);            // more atoms than bytes
  EXPECT_EQ(kind_of(with(4, {0, 0, 0x80, 0x7f})), ErrorKind::damaged);    // base: infinite
  EXPECT_EQ(kind_of(with(8, {0, 0, 0xc0, 0x7f})), ErrorKind::damaged);    // quantum: NaN
  EXPECT_EQ(kind_of(with(8, {0, 0, 0, 0})), ErrorKind::damaged);          // 0
  EXPECT_EQ(kind_of(with(12, {0, 0, 0x80, 0xbf})), ErrorKind::damaged);   // -1
  EXPECT_EQ(kind_of(with(16, {2})), ErrorKind::damaged);                  // kind of dictionary
  EXPECT_EQ(kind_of(with(16, {1})), ErrorKind::damaged);                  // a digest, and bytes too many
}

TEST(PatchParameters, EveryTruncationOfTheFixedPartIsRefused) {
  const std::vector<std::byte> good = serialise_patch_parameters(example());
  for (std::size_t n = 0; n < 17; ++n) EXPECT_EQ(kind_of({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n)}), ErrorKind::damaged) << n;
  // A shorter stream of atoms is refused below its least length, and gives some atoms above it.
  for (std::size_t n = 17; n < good.size(); ++n) {
    const ErrorKind kind = kind_of({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n)});
    EXPECT_TRUE(kind == ErrorKind::damaged || (kind == ErrorKind::usage && n >= 17 + 20)) << n;
  }
}

TEST(PatchParameters, RoundedAtomsAreWithinHalfAStep) {
  const Eigen::MatrixXf D = unit_atoms(5, 20);
  const PatchAtoms atoms = round_atoms(D);
  ASSERT_EQ(atoms.side, 10);
  for (Eigen::Index j = 0; j < D.cols(); ++j)
    for (Eigen::Index i = 0; i < D.rows(); ++i) EXPECT_LE(std::abs(atoms.atom(j)[i] / 32768.0 - static_cast<double>(D(i, j))), 0.5 / 32768 + 1e-9);
}

// Table 4 of the paper, Italy: 3600 x 3600, K = 169, discs 6.5 samples apart.
TEST(PatchParameters, ValueRatioIsThePapers) {
  const std::int64_t cells = 3600 * 3600, discs = 4 * cells / 169;
  EXPECT_NEAR(100 * value_ratio(128, 169, discs, 1, cells).tabulated, 4.9, 0.05);
  EXPECT_NEAR(100 * value_ratio(128, 169, discs, 2, cells).tabulated, 9.7, 0.1);
  EXPECT_NEAR(100 * value_ratio(128, 169, discs, 8, cells).tabulated, 38.0, 0.1);
  EXPECT_NEAR(100 * value_ratio(128, 169, discs, 1, cells).printed, 9.6, 0.05);
  EXPECT_NEAR(100 * value_ratio(128, 169, discs, 8, cells).printed, 42.8, 0.1);
}

}  // namespace
}  // namespace arete
