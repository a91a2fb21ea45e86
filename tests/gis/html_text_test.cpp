#include "gis/html_text.h"

#include <gtest/gtest.h>

namespace arete {
namespace {

TEST(EscapeHtml, LeavesNoTagAndNoEntity) {
  EXPECT_EQ(escape_html("<b a=\"1\">R&D</b>"), "&lt;b a=&quot;1&quot;&gt;R&amp;D&lt;/b&gt;");
  EXPECT_EQ(escape_html("Gr\u00fcn 'x'"), "Gr\u00fcn 'x'");
}

// Test vectors of RFC 4648, section 10.
TEST(Base64, AgreesWithTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\x01"), "//4B");
}

}  // namespace
}  // namespace arete
