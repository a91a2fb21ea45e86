#include "core/support/checksum.h"

#include <string>

#include <gtest/gtest.h>

namespace {

// Known answers of XXH3 for empty input, seed 0, as the xxhash 0.8 specification's reference program prints them (xxhsum -H3, -H2).
TEST(Checksum, AgreesWithTheReferenceProgram) {
  EXPECT_EQ(arete::checksum64("", 0), 0x2d06800538d394c2ull);
  EXPECT_EQ(arete::digest_hex("", 0), "99aa06d3014798d86001c324468d497f");
}

TEST(Checksum, NoticesAnyChangedByte) {
  std::string text(1000, 'a');
  const auto before = arete::checksum64(text.data(), text.size());
  for (char& c : text) {
    c = 'b';
    EXPECT_NE(arete::checksum64(text.data(), text.size()), before);
    c = 'a';
  }
}

}  // namespace
