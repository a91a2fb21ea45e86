#include "tools/report.h"

#include <cstdio>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/error.h"

namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Report, HoldsItsPicturesAndEscapesText) {
  const std::string png = testing::TempDir() + "/arete-report.png";
  std::ofstream(png) << "foobar";
  arete::tools::Report report{.title = "Fish & <chips>", .columns = {"what"}, .rows = {{"a<b"}}, .pictures = {{"A \"picture\"", png}}};
  const std::string html = write_html(report);
  std::remove(png.c_str());
  EXPECT_THAT(html, HasSubstr("<title>Fish &amp; &lt;chips&gt;</title>"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64,Zm9vYmFy\""));
  EXPECT_THAT(html, HasSubstr("<td>a&lt;b</td>"));
  EXPECT_THAT(html, Not(HasSubstr("http")));
}

TEST(Report, HasItsSectionsInOrderAndNothingEmpty) {
  arete::tools::Report report{.title = "t"};
  report.sections.push_back({.heading = "First & foremost", .paragraphs = {"words"}, .svg = "<svg></svg>"});
  report.sections.push_back({.heading = "Second", .level = 3, .columns = {"a", "b"}, .rows = {{"1", "<2>"}}});
  const std::string html = write_html(report);
  EXPECT_LT(html.find("<h2>First &amp; foremost</h2>"), html.find("<h3>Second</h3>"));
  EXPECT_THAT(html, HasSubstr("<figure><svg></svg></figure>"));
  EXPECT_THAT(html, HasSubstr("<th>b</th></tr>\n<tr><td>1</td><td>&lt;2&gt;</td>"));
  EXPECT_THAT(html, Not(HasSubstr("Figures")));
  EXPECT_THAT(html, Not(HasSubstr("Pictures")));
}

TEST(Report, AMissingPictureIsAnError) {
  arete::tools::Report report{.title = "t", .pictures = {{"none", testing::TempDir() + "/arete-no-such.png"}}};
  EXPECT_THROW(write_html(report), arete::Error);
}

}  // namespace
