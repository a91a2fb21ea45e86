#include "core/sparse/dictionary_file.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "core/support/checksum.h"
#include "core/support/error.h"
#include "core/support/file.h"
#include "core/support/random.h"

namespace arete {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

constexpr std::size_t header_bytes = 32, entry_bytes = 64;

Eigen::MatrixXf random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Eigen::MatrixXf matrix(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; ++i)
      matrix(i, j) = static_cast<float>(uniform_at(seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j)) - 0.5);
  return matrix;
}

/// A dictionary with everything that there can be, small enough to change every byte of its file.
Dictionary small_dictionary() {
  Dictionary d;
  d.method = LearningMethod::constrained;
  d.patch_cells = 4;
  d.factor = 2;
  d.cell_size_m = 12.5;
  d.low = random_matrix(16, 3, 1).colwise().normalized();
  d.high = random_matrix(64, 3, 2);
  d.detail = random_matrix(64, 3, 3) * 1e-3f;
  d.sources = {{0, 10, 20, 0}, {1, 30, -4, 7}, {-1, 0, 0, 3}};
  d.exemplars = {"davos west.tif", "alr.tif"};
  d.upsampler = Upsampler{2, 1, {}};
  for (std::uint64_t i = 0; i < 36; ++i) d.upsampler->weights.push_back(static_cast<float>(uniform_at(9, i)));
  d.detail_power = 0.014;
  d.coarse_detail_power = 0.013;
  d.provenance = "arete learn 'davos west.tif' alr.tif x.atoms";
  return d;
}

void expect_same(const Dictionary& a, const Dictionary& b) {
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.patch_cells, b.patch_cells);
  EXPECT_EQ(a.factor, b.factor);
  EXPECT_EQ(a.cell_size_m, b.cell_size_m);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_EQ(a.detail, b.detail);
  ASSERT_EQ(a.sources.size(), b.sources.size());
  for (std::size_t j = 0; j < a.sources.size(); ++j) {
    EXPECT_EQ(a.sources[j].exemplar, b.sources[j].exemplar);
    EXPECT_EQ(a.sources[j].x, b.sources[j].x);
    EXPECT_EQ(a.sources[j].y, b.sources[j].y);
    EXPECT_EQ(a.sources[j].symmetry, b.sources[j].symmetry);
  }
  EXPECT_EQ(a.exemplars, b.exemplars);
  ASSERT_EQ(a.upsampler.has_value(), b.upsampler.has_value());
  if (a.upsampler) {
    EXPECT_EQ(a.upsampler->factor, b.upsampler->factor);
    EXPECT_EQ(a.upsampler->reach, b.upsampler->reach);
    EXPECT_EQ(a.upsampler->weights, b.upsampler->weights);
  }
  EXPECT_EQ(a.detail_power, b.detail_power);
  EXPECT_EQ(a.coarse_detail_power, b.coarse_detail_power);
  EXPECT_EQ(a.provenance, b.provenance);
}

/// Whether the file is refused in the one way that there is; whatever else it throws fails the test.
bool is_refused(std::span<const std::byte> file) {
  try {
    decode_dictionary(file, "x.atoms");
    return false;
  } catch (const Error& error) {
    return (error.kind() == ErrorKind::damaged || error.kind() == ErrorKind::format) && error.what() != std::string() &&
           std::string(error.what()).find('\n') == std::string::npos;
  }
}

ErrorKind kind_of_refusal(std::span<const std::byte> file) {
  try {
    decode_dictionary(file, "x.atoms");
  } catch (const Error& error) {
    return error.kind();
  }
  return ErrorKind::usage;
}

std::string message_of(std::span<const std::byte> file) {
  try {
    decode_dictionary(file, "x.atoms");
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

template <typename T>
T get(const Bytes& file, std::size_t at) {
  T value;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

template <typename T>
void put(Bytes& file, std::size_t at, T value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

/// Makes the checksums right again, as an attacker would; entries that point nowhere keep theirs.
void seal(Bytes& file) {
  const std::size_t count = get<std::uint32_t>(file, 20);
  if (count > (file.size() - header_bytes) / entry_bytes) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = header_bytes + i * entry_bytes;
    const auto offset = get<std::uint64_t>(file, entry + 40), length = get<std::uint64_t>(file, entry + 48);
    if (offset > file.size() || length > file.size() - offset) continue;
    put(file, entry + 56, checksum64(file.data() + offset, length));
  }
  put(file, 8, checksum64(file.data() + 16, header_bytes + count * entry_bytes - 16));
}

/// Where the entry of a section begins.
std::size_t entry_of(const Bytes& file, const std::string& tag) {
  for (std::size_t entry = header_bytes; entry < header_bytes + get<std::uint32_t>(file, 20) * entry_bytes; entry += entry_bytes)
    if (std::string(reinterpret_cast<const char*>(file.data()) + entry,
                    strnlen(reinterpret_cast<const char*>(file.data()) + entry, 16)) == tag)
      return entry;
  ADD_FAILURE() << "no section " << tag;
  return 0;
}

std::size_t data_of(const Bytes& file, const std::string& tag) { return get<std::uint64_t>(file, entry_of(file, tag) + 40); }

TEST(DictionaryFile, ExactStorageLosesNothing) {
  const Dictionary d = small_dictionary();
  expect_same(decode_dictionary(encode_dictionary(d, AtomStorage::exact), "x"), d);
}

TEST(DictionaryFile, CompactStorageErrsByNoMoreThanItSays) {
  Dictionary d = small_dictionary();
  // The largest value just under, at and just over a whole number of steps, and atoms of zeros and of tiny and huge values.
  d.high.col(0) *= 32767.4f / d.high.col(0).cwiseAbs().maxCoeff();
  d.high.col(1).setZero();
  d.high.col(2) *= 1e30f;
  d.detail.col(0) *= 1e-30f;
  d.detail.col(1) *= 65535.9f / d.detail.col(1).cwiseAbs().maxCoeff();
  const Dictionary read = decode_dictionary(encode_dictionary(d), "x");
  for (const auto& [stored, original] : {std::pair{&read.high, &d.high}, std::pair{&read.detail, &d.detail}})
    for (Eigen::Index j = 0; j < original->cols(); ++j) {
      const double largest = static_cast<double>(original->col(j).cwiseAbs().maxCoeff());
      EXPECT_LE(static_cast<double>((stored->col(j) - original->col(j)).cwiseAbs().maxCoeff()), largest / 32767) << j;
    }
  Dictionary expected = d;
  expected.high = read.high;
  expected.detail = read.detail;
  expect_same(read, expected);
}

TEST(DictionaryFile, DigestAndBytesSurviveWritingAndReading) {
  const Dictionary d = small_dictionary();
  const Bytes compact = encode_dictionary(d), exact = encode_dictionary(d, AtomStorage::exact);
  EXPECT_EQ(compact, encode_dictionary(small_dictionary()));
  EXPECT_EQ(encode_dictionary(decode_dictionary(compact, "x")), compact);
  EXPECT_EQ(encode_dictionary(decode_dictionary(exact, "x"), AtomStorage::exact), exact);
  const std::string digest = dictionary_digest(d);
  EXPECT_EQ(digest.size(), 32u);
  EXPECT_EQ(dictionary_digest(decode_dictionary(compact, "x")), digest);
  EXPECT_EQ(dictionary_digest(decode_dictionary(exact, "x")), digest);
  Dictionary other = small_dictionary();
  other.provenance += "?";
  EXPECT_NE(dictionary_digest(other), digest);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Dictionary random = small_dictionary();
    random.high = random_matrix(64, 3, seed) * static_cast<float>(std::exp(20 * (uniform_at(seed, 77) - 0.5)));
    EXPECT_EQ(dictionary_digest(decode_dictionary(encode_dictionary(random), "x")), dictionary_digest(random));
  }
}

TEST(DictionaryFile, PartsMayBeAbsent) {
  Dictionary d = small_dictionary();
  d.high.resize(0, 0);
  d.detail.resize(0, 0);
  d.upsampler.reset();
  d.exemplars.clear();
  d.provenance.clear();
  for (AtomSource& source : d.sources) source.exemplar = -1;
  d.factor = 1;
  expect_same(decode_dictionary(encode_dictionary(d), "x"), d);
}

TEST(DictionaryFile, AnyChangedByteIsRefused) {
  for (const AtomStorage storage : {AtomStorage::compact, AtomStorage::exact}) {
    Bytes file = encode_dictionary(small_dictionary(), storage);
    for (std::size_t i = 0; i < file.size(); ++i)
      for (const int flip : {0x01, 0x80, 0xff}) {
        file[i] ^= static_cast<std::byte>(flip);
        ASSERT_TRUE(is_refused(file)) << "byte " << i << " changed by " << flip;
        file[i] ^= static_cast<std::byte>(flip);
      }
    EXPECT_FALSE(is_refused(file));
  }
}

TEST(DictionaryFile, EveryTruncationAndWhatIsAppendedIsRefused) {
  Bytes file = encode_dictionary(small_dictionary());
  for (std::size_t length = 0; length < file.size(); ++length) {
    // A copy of exactly that length, so that the sanitizer sees a read beyond it.
    const Bytes cut(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length));
    ASSERT_TRUE(is_refused(cut)) << length;
    EXPECT_EQ(kind_of_refusal(cut), length < 8 ? ErrorKind::format : ErrorKind::damaged) << length;
  }
  for (int appended = 0; appended < 100; ++appended) {
    file.push_back(std::byte{0});
    ASSERT_TRUE(is_refused(file));
  }
}

TEST(DictionaryFile, RandomBytesAreRefused) {
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    Bytes file(hash_position(seed, 1) % 700);
    for (std::size_t i = 0; i < file.size(); ++i) file[i] = static_cast<std::byte>(hash_position(seed, 2, i));
    ASSERT_TRUE(is_refused(file)) << seed;
    const Bytes proper = encode_dictionary(small_dictionary());
    // The same behind the proper first bytes, and behind a whole header.
    std::copy_n(proper.begin(), std::min<std::size_t>(file.size(), seed % 2 == 0 ? 8 : 20), file.begin());
    if (file.size() >= header_bytes) put(file, 24, static_cast<std::uint64_t>(file.size()));
    ASSERT_TRUE(is_refused(file)) << seed;
  }
}

// With checksums made right again only the rules stand between the file and the reader.
TEST(DictionaryFile, WhatIsDamagedUnderRightChecksumsIsRefusedOrKeepsTheRules) {
  const Bytes proper = encode_dictionary(small_dictionary());
  const std::size_t table_end = header_bytes + get<std::uint32_t>(proper, 20) * entry_bytes;
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 6000; ++seed) {
    Bytes file = proper;
    // Mostly the table, where the sizes are.
    const std::size_t range = seed % 3 == 0 ? file.size() : table_end;
    for (std::uint64_t change = 0; change <= seed % 4; ++change) {
      const std::size_t at = 20 + hash_position(seed, 3, change) % (range - 20);
      const std::uint64_t value = hash_position(seed, 4, change);
      if (value % 4 == 0 && at + 8 <= file.size())
        put(file, at / 8 * 8, value % 8 == 0 ? ~std::uint64_t{0} >> (value >> 32) % 64 : std::uint64_t{1} << (value >> 32) % 64);
      else
        file[at] = static_cast<std::byte>(value >> 8);
    }
    put(file, 16, std::uint32_t{1});
    put(file, 24, static_cast<std::uint64_t>(file.size()));
    seal(file);
    try {
      const Dictionary d = decode_dictionary(file, "x");
      ASSERT_EQ(find_dictionary_fault(d), "") << seed;
      decode_dictionary(encode_dictionary(d), "x");
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::damaged) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 3000);
}

TEST(DictionaryFile, RulesAreCheckedUnderRightChecksums) {
  const Bytes proper = encode_dictionary(small_dictionary());
  const auto with = [&](const std::string& tag, std::size_t offset, auto value) {
    Bytes file = proper;
    put(file, data_of(file, tag) + offset, value);
    seal(file);
    return file;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(is_refused(with("detail_power", 0, 1.0)));
  EXPECT_FALSE(is_refused(with("source_symmetry", 0, std::uint8_t{7})));
  const std::vector<Bytes> broken = {
      with("method", 0, 3),
      with("method", 0, -1),
      with("patch_cells", 0, 3),
      with("patch_cells", 0, 0),
      with("patch_cells", 0, 6),
      with("patch_cells", 0, -4),
      with("patch_cells", 0, 2000),
      with("factor", 0, 0),
      with("factor", 0, 3),
      with("factor", 0, 1 << 30),
      with("cell_size_m", 0, -1.0),
      with("cell_size_m", 0, std::nan("")),
      with("detail_power", 0, -1.0),
      with("coarse_power", 0, HUGE_VAL),
      with("low", 4, nan),
      with("low", 4, 2.0f),
      with("high_scale", 0, nan),
      with("high_scale", 4, 0.0f),
      with("high_scale", 8, -1.0f),
      with("detail_scale", 0, infinity),
      with("upsampler", 12, nan),
      with("source_exemplar", 0, 2),
      with("source_exemplar", 4, -2),
      with("source_origin", 8, std::int64_t{1} << 62),
      with("source_symmetry", 1, std::uint8_t{8}),
      with("exemplars", 22, 'x'),
      with("exemplars", 14, 'x'),
  };
  for (std::size_t i = 0; i < broken.size(); ++i) EXPECT_EQ(kind_of_refusal(broken[i]), ErrorKind::damaged) << i;
}

TEST(DictionaryFile, SectionsMustFitTogether) {
  const Bytes proper = encode_dictionary(small_dictionary());
  const auto with = [&](const std::string& tag, std::size_t field, auto value) {
    Bytes file = proper;
    put(file, entry_of(file, tag) + field, value);
    seal(file);
    return file;
  };
  const auto huge = ~std::uint64_t{0};
  const std::vector<Bytes> broken = {
      with("low", 0, 'x'),                 // renamed: missing
      with("low", 0, 'A'),                 // no name
      with("low", 3, '\1'),                // no name
      with("low", 15, 'x'),                // a byte behind the name
      with("low", 16, std::uint32_t{3}),   // integers instead of floats
      with("low", 16, std::uint32_t{99}),  // unknown type of a known section
      with("low", 20, std::uint32_t{1}),   // the zero
      with("low", 24, std::uint64_t{17}),  // rows
      with("low", 24, huge),               // overflow
      with("low", 32, huge / 16 + 2),      // 16 x that is 16 again, modulo 2^64
      with("low", 24, std::uint64_t{0}),
      with("low", 40, std::uint64_t{0}),  // offset
      with("low", 40, huge),
      with("low", 48, std::uint64_t{0}),  // length
      with("low", 48, huge),
      with("detail_scale", 11, 'd'),  // steps without their scale
  };
  for (std::size_t i = 0; i < broken.size(); ++i) EXPECT_EQ(kind_of_refusal(broken[i]), ErrorKind::damaged) << i;
  Bytes twice = proper;
  std::memcpy(twice.data() + entry_of(twice, "factor"), "patch_cells", 12);
  seal(twice);
  EXPECT_NE(message_of(twice).find("twice"), std::string::npos);
}

TEST(DictionaryFile, UnknownSectionsAreSkipped) {
  const Dictionary d = small_dictionary();
  const Bytes proper = encode_dictionary(d);
  const std::uint32_t count = get<std::uint32_t>(proper, 20);
  const std::size_t table_end = header_bytes + count * entry_bytes;
  // One more entry and its five bytes at the end; everything else moves by one entry.
  Bytes file(proper.begin(), proper.begin() + static_cast<std::ptrdiff_t>(table_end));
  for (std::uint32_t i = 0; i < count; ++i)
    put(file, header_bytes + i * entry_bytes + 40, get<std::uint64_t>(file, header_bytes + i * entry_bytes + 40) + entry_bytes);
  file.resize(table_end + entry_bytes);
  std::memcpy(file.data() + table_end, "from_tomorrow", 13);
  put(file, table_end + 16, std::uint32_t{1000});
  put(file, table_end + 40, static_cast<std::uint64_t>(proper.size() + entry_bytes));
  put(file, table_end + 48, std::uint64_t{5});
  file.insert(file.end(), proper.begin() + static_cast<std::ptrdiff_t>(table_end), proper.end());
  file.resize(file.size() + 5, std::byte{7});
  put(file, 20, count + 1);
  put(file, 24, static_cast<std::uint64_t>(file.size()));
  seal(file);
  expect_same(decode_dictionary(file, "x"), decode_dictionary(proper, "x"));
  file.back() = std::byte{8};
  EXPECT_EQ(kind_of_refusal(file), ErrorKind::damaged);
}

TEST(DictionaryFile, ANewerVersionAndOtherFilesAreOfAnotherFormat) {
  Bytes file = encode_dictionary(small_dictionary());
  put(file, 16, std::uint32_t{2});
  seal(file);
  EXPECT_EQ(kind_of_refusal(file), ErrorKind::format);
  EXPECT_NE(message_of(file).find("version 2"), std::string::npos);
  put(file, 16, std::uint32_t{0});
  seal(file);
  EXPECT_EQ(kind_of_refusal(file), ErrorKind::damaged);
  const std::string tiff("II*\0 and more than eight bytes", 30);
  EXPECT_EQ(kind_of_refusal(std::as_bytes(std::span(tiff))), ErrorKind::format);
}

TEST(DictionaryFile, WhatBreaksARuleIsNotWritten) {
  const auto refusal = [](const auto& change) {
    Dictionary d = small_dictionary();
    change(d);
    try {
      encode_dictionary(d);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::usage;
  };
  EXPECT_EQ(refusal([](Dictionary& d) { d.low *= 2; }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.low.resize(16, 0); }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.high(5, 1) = void_value; }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.detail.conservativeResize(64, 2); }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.sources.pop_back(); }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.sources[0].exemplar = 2; }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.exemplars[0] += '\0'; }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.upsampler->factor = 4; }), ErrorKind::input);
  EXPECT_EQ(refusal([](Dictionary& d) { d.upsampler->weights.pop_back(); }), ErrorKind::input);
}

TEST(DictionaryFile, FilesAreWrittenAndRecognised) {
  std::string folder = (fs::temp_directory_path() / "arete-atoms-XXXXXX").string();
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  const std::string path = folder + "/x.atoms";
  const Dictionary d = small_dictionary();
  write_dictionary(path, d, false);
  EXPECT_TRUE(is_dictionary_file(path));
  EXPECT_FALSE(is_dictionary_file(folder));
  EXPECT_FALSE(is_dictionary_file(folder + "/none"));
  EXPECT_EQ(dictionary_digest(read_dictionary(path)), dictionary_digest(d));
  EXPECT_EQ(read_file(path), encode_dictionary(d));
  EXPECT_THROW(write_dictionary(path, d, false), Error);
  write_dictionary(path, d, true, AtomStorage::exact);
  expect_same(read_dictionary(path), d);
  std::ofstream(folder + "/text.atoms") << "no dictionary";
  EXPECT_FALSE(is_dictionary_file(folder + "/text.atoms"));
  EXPECT_THROW(read_dictionary(folder + "/text.atoms"), Error);
  fs::remove_all(folder);
}

/// The example of the document is the dictionary of one atom described there.
TEST(DictionaryFile, TheDocumentsExampleIsWhatIsWritten) {
  Dictionary d;
  d.method = LearningMethod::all;
  d.patch_cells = 2;
  d.factor = 1;
  d.cell_size_m = 30;
  d.low.resize(4, 1);
  d.low << 0.5f, -0.5f, 0.5f, -0.5f;
  d.sources = {{0, 3, 5, 1}};
  d.exemplars = {"a.tif"};
  d.provenance = "by hand";

  std::ifstream document(ARETE_SOURCE_DIR "/core/sparse/dictionary-format.md");
  ASSERT_TRUE(document) << "the document is missing";
  Bytes expected;
  // Lines of the example: four spaces, eight digits of an offset, a colon, up to 16 bytes, two spaces before a remark.
  for (std::string line; std::getline(document, line);) {
    if (line.size() < 16 || line.compare(0, 4, "    ") != 0 || line.find(':') != 12) continue;
    ASSERT_EQ(std::stoul(line.substr(4, 8), nullptr, 16), expected.size());
    std::istringstream bytes(line.substr(13, line.find("  ", 13) - 13));
    for (std::string byte; bytes >> byte;) expected.push_back(static_cast<std::byte>(std::stoul(byte, nullptr, 16)));
  }
  const Bytes file = encode_dictionary(d);
  std::ostringstream dump;
  for (std::size_t i = 0; i < file.size(); ++i) {
    char text[32];
    if (i % 16 == 0) {
      std::snprintf(text, sizeof text, "\n    %08zx:", i);
      dump << text;
    }
    std::snprintf(text, sizeof text, " %02x", static_cast<unsigned>(file[i]));
    dump << text;
  }
  EXPECT_EQ(expected, file) << "it should be:" << dump.str();
}

}  // namespace
}  // namespace arete
