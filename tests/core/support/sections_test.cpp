#include "core/support/sections.h"

#include <array>
#include <cstring>

#include <gtest/gtest.h>

#include "core/support/error.h"

namespace arete {
namespace {

using Bytes = std::vector<std::byte>;

constexpr SectionFormat format = {{'T', 'E', 'S', 'T', 1, 2, 3, 4}, 3, "a file of this test"};

/// Two sections, one of them empty.
Bytes small_file() {
  const std::array<std::int16_t, 6> numbers = {1, -2, 3, -4, 5, -6};
  return encode_sections(format, {{"numbers", ElementType::i16, 2, 3, std::as_bytes(std::span(numbers))},
                                  {"a_name_of_16_let", ElementType::f64, 0, 9, {}}});
}

TEST(Sections, WhatIsWrittenIsRead) {
  const Bytes file = small_file();
  EXPECT_EQ(file.size(), 32u + 2 * 64 + 12);
  const std::vector<Section> sections = decode_sections(format, file, "x");
  ASSERT_EQ(sections.size(), 2u);
  EXPECT_EQ(sections[0].tag, "numbers");
  EXPECT_EQ(sections[0].type, ElementType::i16);
  EXPECT_EQ(sections[0].rows, 2u);
  EXPECT_EQ(sections[0].columns, 3u);
  std::int16_t fourth = 0;
  std::memcpy(&fourth, sections[0].bytes.data() + 6, sizeof fourth);
  EXPECT_EQ(fourth, -4);
  EXPECT_EQ(sections[1].tag, "a_name_of_16_let");
  EXPECT_TRUE(sections[1].bytes.empty());
  EXPECT_TRUE(decode_sections(format, encode_sections(format, {}), "x").empty());
}

// Guarantees 1 and 3 of the header, on every byte and every length.
TEST(Sections, AnyChangedByteAndAnyOtherLengthIsRefused) {
  const Bytes proper = small_file();
  for (std::size_t i = 0; i < proper.size(); ++i)
    for (int flip = 1; flip < 256; ++flip) {
      Bytes file = proper;
      file[i] ^= static_cast<std::byte>(flip);
      ASSERT_THROW(decode_sections(format, file, "x"), Error) << i;
    }
  for (std::size_t length = 0; length < 2 * proper.size(); ++length) {
    Bytes file = proper;
    file.resize(length);
    if (length == proper.size()) continue;
    ASSERT_THROW(decode_sections(format, file, "x"), Error) << length;
  }
}

TEST(Sections, OlderVersionsAreReadAndNewerRefused) {
  SectionFormat other = format;
  other.version = 4;
  EXPECT_EQ(decode_sections(other, small_file(), "x").size(), 2u);
  other.version = 2;
  try {
    decode_sections(other, small_file(), "x");
    FAIL() << "a newer version was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::format);
    EXPECT_STREQ(
        error.what(),
        "'x' is a file of this test of version 3, this program reads versions up to 2: update Arete (or the file is damaged)");
  }
  other = format;
  other.magic[7] = 5;
  try {
    decode_sections(other, small_file(), "x");
    FAIL() << "a file of another kind was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::format);
  }
}

}  // namespace
}  // namespace arete
