#include "gis/mesh/input_file.h"

#include <gtest/gtest.h>

#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

// Words and lines across the ends of the buffer of 1 MiB.
TEST(InputFile, GivesLinesWordsAndBytesOfALongFile) {
  TestFolder folder;
  std::string text;
  for (int i = 0; i < 500000; ++i) text += std::to_string(i) + (i % 2 == 0 ? "\r\n" : "\n");
  text += "end";
  put_file(folder / "file", text);
  InputFile lines(folder / "file"), words(folder / "file"), bytes(folder / "file");
  for (int i = 0; i < 500000; ++i) {
    ASSERT_EQ(lines.line(), std::to_string(i));
    ASSERT_EQ(words.word("a word"), std::to_string(i));
  }
  EXPECT_EQ(lines.line(), "end");
  EXPECT_EQ(lines.line_number(), 500001);
  EXPECT_FALSE(lines.line().has_value());
  EXPECT_EQ(words.word("a word"), "end");
  EXPECT_EQ(words.left(), 0u);
  EXPECT_EQ(error_of([&] { words.word("a word"); }).kind(), ErrorKind::input);
  bytes.skip(text.size() - 3, "all");
  EXPECT_EQ(bytes.peek(10), "end");
  EXPECT_EQ(bytes.take(3, "the end").size(), 3u);
  const Error error = error_of([&] { bytes.take(1, "a triangle"); });
  EXPECT_NE(std::string(error.what()).find("ends after " + std::to_string(text.size()) + " bytes, where a triangle was expected"),
            std::string::npos)
      << error.what();
}

TEST(InputFile, RefusesLinesAndWordsWithoutEnd) {
  TestFolder folder;
  put_file(folder / "file", std::string(70000, 'x'));
  InputFile file(folder / "file");
  EXPECT_EQ(error_of([&] { file.line(); }).kind(), ErrorKind::input);
  EXPECT_EQ(error_of([&] { file.word("a word"); }).kind(), ErrorKind::input);
  EXPECT_EQ(error_of([&] { InputFile device("/dev/zero"); }).kind(), ErrorKind::input);
}

TEST(ParseNumber, TakesWholeFiniteWordsOnly) {
  EXPECT_EQ(parse_number("+1.5e3"), 1500);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  for (const char* word : {"", "1,5", "1.5m", "nan", "inf", "1e999", "0x10", "+", "--1"})
    EXPECT_FALSE(parse_number(word)) << word;
  EXPECT_EQ(parse_integer("-12"), -12);
  for (const char* word : {"", "1.0", "9223372036854775808", "1 "}) EXPECT_FALSE(parse_integer(word)) << word;
}

}  // namespace
}  // namespace arete
