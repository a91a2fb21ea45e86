#include "gis/terrain_page.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "core/terrain/ground_style.h"
#include "gis/html_text.h"

namespace arete {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(-400 + 2000 * uniform_at(7, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
  return cells;
}

class WriteTerrainPage : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("arete_page_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static TerrainPage page_of(const std::string& name) {
    TerrainPage page;
    page.title = name;
    PageTerrain terrain;
    terrain.name = name;
    terrain.facts = {"a fact"};
    terrain.heights = quantise_heights(rough(20, 10).view());
    terrain.picture = Picture(20, 10, {90, 140, 90, 255});
    page.terrains.push_back(std::move(terrain));
    return page;
  }
  /// What stands in the element of that id.
  static std::string content(const std::string& html, const std::string& id) {
    const std::size_t tag = html.find("id=\"" + id + "\">"), begin = html.find('>', tag) + 1;
    return tag == std::string::npos ? "" : html.substr(begin, html.find("</script>", begin) - begin);
  }
  fs::path folder_;
};

TEST_F(WriteTerrainPage, TextsNeitherEndElementsNorFillInTheTemplate) {
  const std::string name = "</script><script>alert(1)</script>&\"'<!-- @THREE@ @STYLE@";
  write_terrain_page(path("a.html"), page_of(name));
  const std::string html = read(path("a.html"));
  EXPECT_THAT(html, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(html, HasSubstr("<title>&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;'&lt;!-- @THREE@ @STYLE@</title>"));
  const auto data = nlohmann::json::parse(content(html, "page"));
  EXPECT_EQ(data["terrains"][0]["name"], name);
  EXPECT_EQ(data["interval"], contour_interval(2000));
}

TEST_F(WriteTerrainPage, BytesThatAreNoUtf8DoNotSpoilThePage) {
  write_terrain_page(path("a.html"), page_of("caf\xe9"));
  EXPECT_EQ(nlohmann::json::parse(content(read(path("a.html")), "page"))["terrains"][0]["name"], "caf\uFFFD");
}

TEST_F(WriteTerrainPage, HoldsItsHeightsAndTheLicenceAndNamesNoAddressToLoadFrom) {
  write_terrain_page(path("a.html"), page_of("a"));
  const std::string html = read(path("a.html"));
  const std::vector<std::byte> packed = pack_heights(page_of("a").terrains[0].heights);
  EXPECT_EQ(content(html, "heights-0"), base64({reinterpret_cast<const char*>(packed.data()), packed.size()}));
  EXPECT_EQ(content(html, "heights-1"), "");
  EXPECT_THAT(content(html, "three"), Not(HasSubstr(" ")));
  EXPECT_THAT(html, HasSubstr("Copyright (c) 2010-2019 three.js authors"));
  EXPECT_THAT(html, HasSubstr("Permission is hereby granted, free of charge"));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  for (const char* loading : {"src=\"http", "src=\"//", "href=\"http", "url(http", "@import"}) EXPECT_THAT(html, Not(HasSubstr(loading)));
}

TEST_F(WriteTerrainPage, HasTheSameBytesEachTimeAndLeavesNothingBeside) {
  write_terrain_page(path("a.html"), page_of("a"));
  write_terrain_page(path("b.html"), page_of("a"));
  EXPECT_EQ(read(path("a.html")), read(path("b.html")));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
}

TEST_F(WriteTerrainPage, NeverReplacesAPageUnlessTold) {
  std::ofstream(path("a.html")) << "mine";
  EXPECT_THROW(write_terrain_page(path("a.html"), page_of("a")), Error);
  EXPECT_EQ(read(path("a.html")), "mine");
  write_terrain_page(path("a.html"), page_of("a"), true);
  EXPECT_GT(read(path("a.html")).size(), 200000u);
}

}  // namespace
}  // namespace arete
