#include "core/codec/tree_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/codec/byte_stream.h"
#include "core/support/checksum.h"
#include "core/support/deflate.h"
#include "core/support/error.h"
#include "core/support/random.h"

namespace arete {
namespace {

TreeHeader sample_header() {
  TreeHeader header;
  header.grid = NodeGrid({100, 70}, 32);
  header.type = ValueType::int16;
  header.scale = 0.5;
  header.offset = -3;
  header.geo.transform = {500000, 30, 0, 5200000, 0, -30};
  header.geo.crs_wkt = "EPSG:32632";
  header.geo.nodata = -32768;
  header.geo.vertical_unit = "foot";
  header.geo.metres_per_unit = 0.3048;
  header.geo.registration = Registration::point;
  header.band_name = "elevation";
  header.metadata = {{"AREA", "Alps"}, {"EMPTY", ""}};
  header.claim = TreeClaim::psnr;
  header.claimed = 61.5;
  header.parameters = {std::byte{1}, std::byte{2}};
  header.root = {std::byte{7}};
  return header;
}

std::vector<std::byte> stream_of(std::size_t index) { return std::vector<std::byte>(index % 4 == 3 ? 0 : index % 7 + 1, static_cast<std::byte>(index)); }

std::vector<std::byte> write(const TreeHeader& header) {
  std::vector<std::byte> file;
  TreeWriter writer([&](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  for (std::int64_t i = 0; i < header.grid.node_count(); ++i) writer.add_node(stream_of(static_cast<std::size_t>(i)));
  const std::uint64_t length = writer.finish(header);
  EXPECT_EQ(length, file.size());
  return file;
}

// Opens a file and reads all of it: what its damage would change.
void read_all_of(std::span<const std::byte> bytes) {
  const TreeFile file(view_bytes(bytes), "some.sct");
  for (std::size_t i = 0; i < file.nodes().size(); ++i) file.read_node(static_cast<std::int64_t>(i));
}

TEST(TreeFile, GivesBackAllOfTheHeader) {
  const TreeHeader header = sample_header();
  const std::vector<std::byte> bytes = write(header);
  const TreeFile file(view_bytes(bytes), "some.sct");
  const TreeHeader& read = file.header();
  EXPECT_EQ(read.grid.size(), header.grid.size());
  EXPECT_EQ(read.grid.side(), header.grid.side());
  EXPECT_EQ(read.type, header.type);
  EXPECT_EQ(read.scale, header.scale);
  EXPECT_EQ(read.offset, header.offset);
  EXPECT_EQ(read.geo.transform, header.geo.transform);
  EXPECT_EQ(read.geo.crs_wkt, header.geo.crs_wkt);
  EXPECT_EQ(read.geo.nodata, header.geo.nodata);
  EXPECT_EQ(read.geo.vertical_unit, header.geo.vertical_unit);
  EXPECT_EQ(read.geo.metres_per_unit, header.geo.metres_per_unit);
  EXPECT_EQ(read.geo.registration, header.geo.registration);
  EXPECT_EQ(read.band_name, header.band_name);
  EXPECT_EQ(read.metadata, header.metadata);
  EXPECT_EQ(read.claim, header.claim);
  EXPECT_EQ(read.claimed, header.claimed);
  EXPECT_EQ(read.parameters, header.parameters);
  EXPECT_EQ(read.root, header.root);
  for (std::size_t i = 0; i < file.nodes().size(); ++i) EXPECT_EQ(file.read_node(static_cast<std::int64_t>(i)), stream_of(i));
}

TEST(TreeFile, ABareHeaderIsShort) {
  TreeHeader header;
  header.grid = NodeGrid({8, 8}, 32);
  EXPECT_LE(write(header).size(), 30U);
}

TEST(TreeFile, RotatedTransformsAndNoTransform) {
  TreeHeader header = sample_header();
  header.geo.transform = {1, 2, 3, 4, 5, 6};
  const std::vector<std::byte> rotated = write(header);
  EXPECT_EQ(TreeFile(view_bytes(rotated), "x").header().geo.transform, header.geo.transform);
  header.geo.transform.reset();
  const std::vector<std::byte> none = write(header);
  EXPECT_FALSE(TreeFile(view_bytes(none), "x").header().geo.transform.has_value());
}

TEST(TreeFile, EveryTruncationIsNoticed) {
  const std::vector<std::byte> bytes = write(sample_header());
  for (std::size_t length = 0; length < bytes.size(); ++length) EXPECT_THROW(read_all_of(std::span(bytes).first(length)), Error) << length;
}

TEST(TreeFile, EveryChangedByteIsNoticed) {
  std::vector<std::byte> bytes = write(sample_header());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int change : {1, 128, 255}) {
      bytes[i] ^= static_cast<std::byte>(change);
      EXPECT_THROW(read_all_of(bytes), Error) << "byte " << i;
      bytes[i] ^= static_cast<std::byte>(change);
    }
}

// A directory that lies about the size, with a checksum that fits: refused before memory is asked for.
// Found by tests/fuzz/tree_fuzz.cpp: none of its bytes were copied to nowhere.
TEST(TreeFile, AnEmptyDirectoryIsNoticed) {
  const std::uint8_t bytes[] = {0x89, 'S', 'C', 'T', 0, 0, 0, 0, 0, 0, 0, 0, 1, 'S', 'C', 'T'};
  EXPECT_THROW(read_all_of(std::as_bytes(std::span(bytes))), Error);
}

TEST(TreeFile, CountsBeyondTheFileAreRefused) {
  TreeHeader header = sample_header();
  header.grid = NodeGrid({2000000000, 2000000000}, 32);
  std::vector<std::byte> file;
  TreeWriter writer([&](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  writer.finish(header);
  try {
    read_all_of(file);
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::damaged);
    EXPECT_NE(std::string(error.what()).find("index is shorter"), std::string::npos) << error.what();
  }
}

// A file of one cell, right but for its texts.
std::vector<std::byte> with_packed_texts(const std::string& texts) {
  ByteWriter directory;
  for (std::uint8_t byte : {1, 2, 1, 1, 5, 128, 1}) directory.put_u8(byte);
  directory.put_blob(deflate_bytes(std::as_bytes(std::span(texts))));
  for (std::uint8_t byte : {0, 0, 0}) directory.put_u8(byte);
  const auto length = static_cast<std::uint32_t>(directory.bytes().size());
  const std::uint32_t checksum = crc32_of(directory.bytes());
  ByteWriter file;
  for (std::uint8_t byte : {0x89, 0x53, 0x43, 0x54}) file.put_u8(byte);
  file.put_bytes(directory.bytes());
  file.put(length);
  file.put(checksum);
  for (std::uint8_t byte : {1, 0x53, 0x43, 0x54}) file.put_u8(byte);
  return file.take();
}

TEST(TreeFile, TextsThatUnpackToTooMuchAreRefused) {
  using namespace std::string_literals;
  EXPECT_NO_THROW(read_all_of(with_packed_texts("EPSG:2056\0band\0A\0first\0B\0second\0"s)));
  for (const std::string& texts : {""s, "EPSG:2056\0"s, "EPSG:2056\0band\0A\0"s, "EPSG:2056\0band"s, "\0\0A\0first\0A\0second\0"s,
                                   std::string(1 << 23, 'a') + "\0\0"s, std::string(1 << 18, '\0')})
    EXPECT_THROW(read_all_of(with_packed_texts(texts)), Error) << texts.size();
}

TEST(TreeFile, TextsBeyondTheLimitsAreNotWritten) {
  TreeHeader header = sample_header();
  header.metadata["LONG"] = std::string(1 << 22, 'a');
  EXPECT_THROW(write(header), Error);
  header.metadata.clear();
  for (int i = 0; i <= 1 << 16; ++i) header.metadata[std::to_string(i)] = "";
  EXPECT_THROW(write(header), Error);
}

TEST(TreeFile, AClaimIsAPositiveNumber) {
  TreeHeader header = sample_header();
  for (double claimed : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    header.claimed = claimed;
    EXPECT_THROW(read_all_of(write(header)), Error) << claimed;
  }
}

TEST(TreeFile, OtherFilesAreOfAnotherFormat) {
  const std::string text = "ncols 4\nnrows 4\nthis is no tree at all";
  try {
    read_all_of(std::as_bytes(std::span(text)));
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::format);
  }
}

}  // namespace
}  // namespace arete
