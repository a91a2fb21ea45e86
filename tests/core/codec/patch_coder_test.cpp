#include "core/codec/patch_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/sparse/patches.h"
#include "core/support/error.h"
#include "core/support/random.h"
#include "tests/core/codec/codec_terrain.h"

namespace arete {
namespace {

PatchStreams encode(const Raster<float>& cells, PatchCodingOptions options) {
  NoProgress progress;
  return encode_patches(cells.view(), options, progress);
}

PatchCodingOptions small(int atoms = 16, int sparsity = 2, int threads = 1) {
  PatchCodingOptions options;
  options.atoms = atoms;
  options.sparsity = sparsity;
  options.radius = 5;
  options.node_side = 64;
  options.threads = threads;
  return options;
}

Raster<float> decode(const PatchStreams& streams, int level, const Window& window, int threads = 1) {
  return decode_patches(streams.parameters, streams.root, [&](std::int64_t i) { return streams.nodes[static_cast<std::size_t>(i)]; },
                        level, window, threads);
}

Raster<float> decode(const PatchStreams& streams) {
  const Size size = streams.parameters.grid.size();
  return decode(streams, 0, {0, 0, size.width, size.height});
}

double squared_error(const Raster<float>& a, const Raster<float>& b) {
  double sum = 0;
  for (std::int64_t i = 0; i < a.size().cells(); ++i) sum += std::pow(static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]), 2);
  return sum;
}

TEST(PatchCoder, MoreCoefficientsComeCloser) {
  const Raster<float> cells = codec_terrain(150, 120);
  double error = 1e30;
  for (int sparsity : {1, 2, 4, 8}) {
    const PatchStreams streams = encode(cells, small(32, sparsity));
    EXPECT_LT(streams.squared_error, 0.8 * error) << sparsity;
    EXPECT_NEAR(streams.squared_error / squared_error(decode(streams), cells), 1, 1e-9) << "the error is that of what is decoded";
    error = streams.squared_error;
  }
}

TEST(PatchCoder, QuantisationCostsNoMoreThanAsked) {
  const Raster<float> cells = codec_terrain(150, 120);
  std::int64_t bytes = 1 << 30;
  for (double loss : {0.01, 0.1, 1.0}) {
    PatchCodingOptions options = small(32, 2);
    options.quantiser_loss_db = loss;
    const PatchStreams streams = encode(cells, options);
    EXPECT_LE(10 * std::log10(streams.squared_error / streams.unquantised_squared_error), loss);
    EXPECT_LT(streams.bytes(), bytes);
    bytes = streams.bytes();
  }
}

// What is written is what is read: parameters through their bytes.
TEST(PatchCoder, ParametersTravelAsBytes) {
  const Raster<float> cells = codec_terrain(100, 70);
  PatchStreams streams = encode(cells, small());
  const Raster<float> before = decode(streams);
  streams.parameters = parse_patch_parameters(serialise_patch_parameters(streams.parameters), "tree", streams.parameters.grid, {});
  EXPECT_EQ(squared_error(decode(streams), before), 0);
}

// Exactness (Guérin et al. 2016): every patch of the terrain an atom, one coefficient each.
TEST(PatchCoder, ACompleteDictionaryGivesTheTerrainBack) {
  const Raster<float> cells = codec_terrain(60, 50);
  PatchCodingOptions options = small(0, 1);
  Eigen::MatrixXf D = extract_patches(cells.view(), make_patch_grid(10), {.edges = PatchEdges::replicate, .leave_out_flat = true}).values;
  D.colwise().normalize();
  options.dictionary = &D;
  const PatchStreams streams = encode(cells, options);
  const Raster<float> decoded = decode(streams);
  // Means within half a quantum, coefficients within half a quantum of a unit atom, atoms within 2^-16 of their norm, over a cover
  // of at least one half.
  const double most = static_cast<double>(streams.parameters.mean_quantum) + static_cast<double>(streams.parameters.coefficient_quantum) + 4 * 4 * 1500 * 0x1p-16;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) EXPECT_NEAR(decoded.data()[i], cells.data()[i], most);
  EXPECT_LT(std::sqrt(streams.squared_error / 3000), 0.02);
}

TEST(PatchCoder, FlatTerrainIsExactAndTakesNoStreams) {
  const Raster<float> cells(90, 70, 512.375F);
  const PatchStreams streams = encode(cells, small());
  for (const std::vector<std::byte>& node : streams.nodes) EXPECT_TRUE(node.empty());
  EXPECT_EQ(squared_error(decode(streams), cells), 0);
  EXPECT_EQ(streams.parameters.atoms.count, 0);
}

TEST(PatchCoder, WindowsAreTheWhole) {
  const Raster<float> cells = codec_terrain(200, 141);
  const PatchStreams streams = encode(cells, small());
  const Raster<float> finest = decode(streams);
  for (int level = 0; level <= streams.parameters.grid.levels(); ++level) {
    const Size size = streams.parameters.grid.level_size(level);
    for (std::uint64_t i = 0; i < 12; ++i) {
      const auto x = static_cast<std::int64_t>(hash_position(1, i) % static_cast<std::uint64_t>(size.width));
      const auto y = static_cast<std::int64_t>(hash_position(2, i) % static_cast<std::uint64_t>(size.height));
      const Window window{x, y, 1 + static_cast<std::int64_t>(hash_position(3, i) % static_cast<std::uint64_t>(size.width - x)),
                          1 + static_cast<std::int64_t>(hash_position(4, i) % static_cast<std::uint64_t>(size.height - y))};
      const Raster<float> part = decode(streams, level, window, 7);
      for (std::int64_t row = 0; row < window.height; ++row)
        for (std::int64_t column = 0; column < window.width; ++column)
          ASSERT_EQ(part(column, row), finest((x + column) << level, (y + row) << level)) << "level " << level;
    }
  }
}

TEST(PatchCoder, AWindowTouchesOnlyItsNodes) {
  const Raster<float> cells = codec_terrain(256, 256);
  const PatchStreams streams = encode(cells, small());
  const NodeGrid& grid = streams.parameters.grid;
  std::set<std::int64_t> touched;
  decode_patches(streams.parameters, {}, [&](std::int64_t i) {
    touched.insert(i);
    return streams.nodes[static_cast<std::size_t>(i)];
  }, 0, {70, 140, 40, 20}, 1);
  EXPECT_EQ(touched, (std::set<std::int64_t>{grid.index({1, 1, 2})}));
  for (std::size_t i = 0; i < streams.nodes.size(); ++i)
    if (grid.address(static_cast<std::int64_t>(i)).level != 1) {
      EXPECT_TRUE(streams.nodes[i].empty());
    }
}

TEST(PatchCoder, ThreadsGiveTheSameBytes) {
  const Raster<float> cells = codec_terrain(160, 130);
  for (const PatchLearning learning : {PatchLearning::ksvd, PatchLearning::constrained}) {
    PatchCodingOptions options = small();
    options.learning = learning;
    const PatchStreams one = encode(cells, options);
    for (int threads : {2, 7}) {
      options.threads = threads;
      const PatchStreams other = encode(cells, options);
      EXPECT_EQ(serialise_patch_parameters(one.parameters), serialise_patch_parameters(other.parameters));
      EXPECT_EQ(one.nodes, other.nodes);
      EXPECT_EQ(one.squared_error, other.squared_error);
    }
  }
}

TEST(PatchCoder, OddAndTinyRasters) {
  for (const Size size : {Size{1, 1}, Size{1, 40}, Size{9, 1}, Size{33, 65}, Size{8, 8}, Size{2, 3}}) {
    const Raster<float> cells = codec_terrain(size.width, size.height);
    PatchCodingOptions options = small(64, 8);
    options.radius = 2;
    const PatchStreams streams = encode(cells, options);
    EXPECT_LT(std::sqrt(streams.squared_error / static_cast<double>(size.cells())), 6) << size.width << "x" << size.height;
    EXPECT_NEAR(squared_error(decode(streams), cells), streams.squared_error, 1e-6 * streams.squared_error + 1e-12);
    EXPECT_EQ(streams.root.empty(), streams.nodes.size() > 0 || size.cells() == 1);
  }
}

TEST(PatchCoder, AGivenDictionaryIsEmbeddedOrNamed) {
  const Raster<float> cells = codec_terrain(150, 120);
  const Eigen::MatrixXf D = [&] {
    Eigen::MatrixXf all = extract_patches(codec_terrain(90, 60).view(), make_patch_grid(10), {.leave_out_flat = true}).values;
    all.colwise().normalize();
    return Eigen::MatrixXf(all.leftCols(64));
  }();
  PatchCodingOptions options = small();
  options.dictionary = &D;
  const PatchStreams embedded = encode(cells, options);
  options.dictionary_name = "00112233445566778899aabbccddeeff";
  const PatchStreams named = encode(cells, options);
  EXPECT_EQ(named.parameters.atoms.samples, round_atoms(D).samples);
  EXPECT_LT(serialise_patch_parameters(named.parameters).size(), 40U);
  EXPECT_NEAR(embedded.unquantised_squared_error / named.unquantised_squared_error, 1, 1e-6);
  PatchStreams read = named;
  read.parameters = parse_patch_parameters(serialise_patch_parameters(named.parameters), "tree", named.parameters.grid, [&](const std::string&) { return D; });
  EXPECT_EQ(squared_error(decode(read), decode(named)), 0);
}

TEST(PatchCoder, RefusesOptionsOutOfRange) {
  const Raster<float> cells = codec_terrain(40, 40);
  const auto refused = [&](const PatchCodingOptions& options) {
    try {
      encode(cells, options);
    } catch (const Error& error) {
      return error.kind() == ErrorKind::usage;
    }
    return false;
  };
  PatchCodingOptions options = small();
  options.radius = 1;
  EXPECT_TRUE(refused(options));
  options = small(16, 65);
  EXPECT_TRUE(refused(options));
  const Eigen::MatrixXf other = Eigen::MatrixXf::Identity(64, 8);
  options = small();
  options.dictionary = &other;
  EXPECT_TRUE(refused(options));
}

TEST(PatchCoder, AnyStreamsDecode) {
  const Raster<float> cells = codec_terrain(90, 70);
  const PatchStreams good = encode(cells, small());
  for (std::uint64_t i = 0; i < 100; ++i) {
    PatchStreams streams = good;
    for (std::vector<std::byte>& node : streams.nodes) {
      if (node.empty()) continue;
      if (i % 2) node.resize(hash_position(1, i) % node.size());
      if (!node.empty()) node[hash_position(2, i) % node.size()] = static_cast<std::byte>(hash_position(3, i));
    }
    const Raster<float> decoded = decode(streams);
    for (std::int64_t c = 0; c < decoded.size().cells(); ++c) ASSERT_TRUE(std::isfinite(decoded.data()[c]));
  }
}

TEST(PatchCoder, AnyParametersDecodeOrAreRefused) {
  const Raster<float> cells = codec_terrain(90, 70);
  const PatchStreams good = encode(cells, small(8));
  const std::vector<std::byte> bytes = serialise_patch_parameters(good.parameters);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::vector<std::byte> changed = bytes;
    changed[at] ^= static_cast<std::byte>(1 + hash_position(1, at) % 255);
    PatchStreams streams = good;
    try {
      streams.parameters = parse_patch_parameters(changed, "tree", good.parameters.grid, [](const std::string&) -> Eigen::MatrixXf {
        throw Error(ErrorKind::input, "no such dictionary");
      });
    } catch (const Error&) {
      continue;
    }
    const Raster<float> decoded = decode(streams);
    for (std::int64_t c = 0; c < decoded.size().cells(); ++c) ASSERT_TRUE(std::isfinite(decoded.data()[c])) << at;
  }
}

}  // namespace
}  // namespace arete
