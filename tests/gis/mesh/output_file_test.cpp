#include "gis/mesh/output_file.h"

#include <gtest/gtest.h>

#include <clocale>

#include "gis/mesh/input_file.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(NumberText, IsShortAndReadsBackAsTheSameDouble) {
  const struct {
    double value;
    const char* text;
  } cases[] = {{0, "0"},
               {-0.0, "-0"},
               {0.1, "0.1"},
               {1000000, "1000000"},
               {450123.456789, "450123.456789"},
               {1e-7, "0.0000001"},
               {1e-9, "1e-09"},
               {1e300, "1e+300"},
               {-6378137.25, "-6378137.25"},
               {9999999999999998, "9999999999999998"}};
  for (const auto& c : cases) {
    EXPECT_EQ(number_text(c.value), c.text);
    EXPECT_EQ(parse_number(c.text), c.value);
  }
  // Many binary orders; the bits come from a linear congruence (Knuth, MMIX).
  std::uint64_t bits = 1;
  for (int i = 0; i < 100000; ++i) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(parse_number(number_text(value)), value);
  }
}

TEST(OutputFile, WritesWhatPassesItsBuffer) {
  TestFolder folder;
  std::string expected;
  OutputFile file(folder / "file");
  for (int i = 0; i < 400000; ++i) {
    file.integer(i - 5);
    file.text(",");
    expected += std::to_string(i - 5) + ",";
  }
  file.text(std::string(3 << 20, 'x'));
  file.binary(std::uint32_t{0x64636261});
  file.close();
  EXPECT_EQ(get_file(folder / "file"), expected + std::string(3 << 20, 'x') + "abcd");
}

TEST(OutputFile, SaysThatTheDiskIsFullInTheMiddleToo) {
  OutputFile file("/dev/full");
  const Error error = error_of([&] {
    for (int i = 0; i < 100; ++i) file.text(std::string(1 << 16, 'x'));
  });
  EXPECT_EQ(error.kind(), ErrorKind::disk);
  EXPECT_STREQ(error.what(), "cannot write '/dev/full': No space left on device");
}

}  // namespace
}  // namespace arete
