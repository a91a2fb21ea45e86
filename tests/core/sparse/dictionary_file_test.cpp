#include "core/sparse/dictionary_file.h"

#include <cstring>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

Eigen::MatrixXf random_matrix(std::int64_t rows, std::int64_t columns, std::uint64_t seed) {
  Eigen::MatrixXf values(rows, columns);
  for (std::int64_t j = 0; j < columns; ++j)
    for (std::int64_t i = 0; i < rows; ++i) values(i, j) = static_cast<float>(uniform_at(seed, i, j) - 0.5);
  return values;
}

Dictionary small_dictionary() {
  Dictionary d;
  d.method = LearningMethod::constrained;
  d.patch_cells = 2;
  d.factor = 2;
  d.cell_size_m = 30.5;
  d.low = random_matrix(4, 3, 1).colwise().normalized();
  d.high = random_matrix(16, 3, 2);
  d.detail = random_matrix(16, 3, 3);
  d.sources = {{0, 5, -6, 0}, {1, 1ll << 40, 7, 7}, {-1, 0, 0, 0}};
  d.exemplars = {"davos.tif", "île d'Oléron.tif"};
  d.provenance = "arete learn davos.tif";
  d.upsampler = Upsampler{2, 1, std::vector<float>(36, 0.25f)};
  d.arrays["use"] = random_matrix(1, 3, 4);
  return d;
}

void expect_equal(const Dictionary& a, const Dictionary& b) {
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.patch_cells, b.patch_cells);
  EXPECT_EQ(a.factor, b.factor);
  EXPECT_EQ(a.cell_size_m, b.cell_size_m);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_EQ(a.detail, b.detail);
  ASSERT_EQ(a.sources.size(), b.sources.size());
  for (std::size_t i = 0; i < a.sources.size(); ++i) {
    EXPECT_EQ(a.sources[i].exemplar, b.sources[i].exemplar);
    EXPECT_EQ(a.sources[i].x, b.sources[i].x);
    EXPECT_EQ(a.sources[i].y, b.sources[i].y);
    EXPECT_EQ(a.sources[i].symmetry, b.sources[i].symmetry);
  }
  EXPECT_EQ(a.exemplars, b.exemplars);
  EXPECT_EQ(a.provenance, b.provenance);
  ASSERT_EQ(a.upsampler.has_value(), b.upsampler.has_value());
  if (a.upsampler) {
    EXPECT_EQ(a.upsampler->factor, b.upsampler->factor);
    EXPECT_EQ(a.upsampler->reach, b.upsampler->reach);
    EXPECT_EQ(a.upsampler->weights, b.upsampler->weights);
  }
  EXPECT_EQ(a.arrays, b.arrays);
}

// Whether the bytes are refused as they must be: not a dictionary, or a damaged one.
bool is_refused(const std::vector<std::byte>& bytes) {
  try {
    decode_dictionary(bytes);
  } catch (const Error& error) {
    return error.kind() == ErrorKind::damaged || error.kind() == ErrorKind::format;
  }
  return false;
}

TEST(DictionaryFile, HoldsTheDictionary) {
  const Dictionary dictionary = small_dictionary();
  const std::vector<std::byte> bytes = encode_dictionary(dictionary);
  expect_equal(decode_dictionary(bytes), dictionary);
  EXPECT_EQ(encode_dictionary(decode_dictionary(bytes)), bytes);
}

TEST(DictionaryFile, HoldsOneWithoutPairs) {
  Dictionary dictionary;
  dictionary.patch_cells = 4;
  dictionary.low = random_matrix(16, 2, 5).colwise().normalized();
  dictionary.sources.resize(2);
  dictionary.sources[0].exemplar = dictionary.sources[1].exemplar = -1;
  expect_equal(decode_dictionary(encode_dictionary(dictionary)), dictionary);
}

TEST(DictionaryFile, AnyChangedByteIsRefused) {
  const std::vector<std::byte> good = encode_dictionary(small_dictionary());
  std::vector<std::byte> bytes = good;
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const int change : {0x01, 0x80, 0xff}) {
      bytes[i] = good[i] ^ static_cast<std::byte>(change);
      ASSERT_TRUE(is_refused(bytes)) << "byte " << i << " xor " << change;
    }
    bytes[i] = good[i];
  }
}

TEST(DictionaryFile, AnyTruncationOrExtensionIsRefused) {
  const std::vector<std::byte> good = encode_dictionary(small_dictionary());
  for (std::size_t length = 0; length < good.size(); ++length)
    ASSERT_TRUE(is_refused({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)})) << length;
  std::vector<std::byte> longer = good;
  longer.push_back(std::byte{0});
  EXPECT_TRUE(is_refused(longer));
}

TEST(DictionaryFile, ANewerVersionIsNamed) {
  std::vector<std::byte> bytes = encode_dictionary(small_dictionary());
  bytes[8] = std::byte{2};
  try {
    decode_dictionary(bytes, "x.atoms");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::format);
    EXPECT_STREQ(error.what(), "x.atoms is of format version 2, this program reads up to 1: use a newer arete");
  }
}

TEST(DictionaryFile, BrokenRulesAreNotStored) {
  const auto refuses = [](auto&& breaks) {
    Dictionary dictionary = small_dictionary();
    breaks(dictionary);
    EXPECT_THROW(encode_dictionary(dictionary), Error);
  };
  refuses([](Dictionary& d) { d.patch_cells = 3; });
  refuses([](Dictionary& d) { d.factor = 3; });
  refuses([](Dictionary& d) { d.low.col(1) *= 2; });
  refuses([](Dictionary& d) { d.high(3, 1) = std::numeric_limits<float>::quiet_NaN(); });
  refuses([](Dictionary& d) { d.sources.pop_back(); });
  refuses([](Dictionary& d) { d.sources[0].exemplar = 2; });
  refuses([](Dictionary& d) { d.upsampler->weights.pop_back(); });
  refuses([](Dictionary& d) { d.arrays["low"] = d.low; });
  refuses([](Dictionary& d) { d.arrays["A name"] = d.low; });
}

TEST(DictionaryFile, DigestNamesTheContents) {
  Dictionary dictionary = small_dictionary();
  const std::string digest = dictionary_digest(dictionary);
  EXPECT_EQ(digest.size(), 32u);
  EXPECT_EQ(digest, dictionary_digest(small_dictionary()));
  dictionary.high(0, 0) += 1;
  EXPECT_NE(digest, dictionary_digest(dictionary));
}

}  // namespace
}  // namespace arete
