#include "gis/terrain_page.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/support/deflate.h"
#include "core/support/error.h"
#include "core/terrain/ground_style.h"
#include "gis/html_text.h"
#include "gis/staged_files.h"

// Made by CMake from the files of gis/page/ and of three.js.
extern "C" {
extern const char arete_page_html[], arete_page_html_end[];
extern const char arete_page_css[], arete_page_css_end[];
extern const char arete_page_js[], arete_page_js_end[];
extern const char arete_page_licence[], arete_page_licence_end[];
extern const char arete_page_three[], arete_page_three_end[];
}

namespace arete {
namespace {

// Three times smaller than the best, and no difference to be seen.
constexpr int jpeg_quality = 90;

std::string_view between(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

std::string base64_of(const std::vector<std::byte>& bytes) { return base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()}); }

/// JSON that neither ends the script element that it stands in nor opens a comment there; bytes that are not UTF-8 become U+FFFD.
std::string script_json(const nlohmann::json& data) {
  std::string safe;
  for (const char c : data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string jpeg(const Picture& picture, const StagedFiles& files) {
  const std::filesystem::path path = files.scratch("picture.jpg");
  std::filesystem::create_directories(path.parent_path());
  write_picture(path.string(), picture, true, jpeg_quality);
  std::string bytes;
  {
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
    if (!file && !file.eof()) bytes.clear();
  }
  if (bytes.empty()) throw Error(ErrorKind::disk, "cannot read back the picture '" + path.string() + "'");
  std::filesystem::remove_all(path.parent_path());
  return bytes;
}

/// Metres between contours that suit all terrains together.
double page_interval(const std::vector<PageTerrain>& terrains) {
  double low = INFINITY, high = -INFINITY;
  for (const PageTerrain& terrain : terrains)
    for (const std::uint16_t step : terrain.heights.steps) {
      if (step == PageHeights::void_step) continue;
      const double height = terrain.heights.low_m + step * terrain.heights.step_m;
      low = std::min(low, height), high = std::max(high, height);
    }
  return contour_interval(high - low);
}

std::string css_colour(const Colour& colour) {
  char text[16];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

nlohmann::json describe(const PageTerrain& terrain) {
  const PageHeights& heights = terrain.heights;
  return {{"name", terrain.name}, {"facts", terrain.facts}, {"width", heights.size.width}, {"height", heights.size.height},
          {"low", heights.low_m}, {"step", heights.step_m}, {"placement", terrain.placement},
          {"picture", {terrain.picture.width(), terrain.picture.height()}}, {"pixelsPerCell", terrain.pixels_per_cell}};
}

/// Replaces each `@NAME@` of the template that is given; other text stays.
std::string fill_in(std::string_view text, const std::vector<std::pair<std::string_view, std::string_view>>& values) {
  std::string result;
  while (!text.empty()) {
    std::size_t first = std::string_view::npos;
    const std::pair<std::string_view, std::string_view>* found = nullptr;
    for (const auto& value : values)
      if (const std::size_t at = text.find(value.first); at < first) first = at, found = &value;
    if (found == nullptr) break;
    result.append(text.substr(0, first)).append(found->second);
    text.remove_prefix(first + found->first.size());
  }
  return result.append(text);
}

}  // namespace

void write_terrain_page(const std::string& path, const TerrainPage& page, bool overwrite) {
  assert(page.terrains.size() == 1 || page.terrains.size() == 2);
  StagedFiles files(path, overwrite);
  nlohmann::json data = {{"terrains", nlohmann::json::array()}, {"ramp", nlohmann::json::array()}, {"low", page.low_m}, {"high", page.high_m},
                         {"exaggeration", page.exaggeration}, {"metric", page.metric}, {"interval", page_interval(page.terrains)},
                         {"credit", page.credit}, {"version", ARETE_VERSION}};
  for (const Colour& colour : page.ramp) data["ramp"].push_back(css_colour(colour));
  std::string elements;
  for (std::size_t i = 0; i < page.terrains.size(); ++i) {
    const PageTerrain& terrain = page.terrains[i];
    data["terrains"].push_back(describe(terrain));
    const std::string number = std::to_string(i);
    elements += "<script type=\"text/plain\" id=\"heights-" + number + "\">" + base64_of(pack_heights(terrain.heights)) + "</script>\n";
    elements += "<img hidden alt=\"\" id=\"picture-" + number + "\" src=\"data:image/jpeg;base64," + base64(jpeg(terrain.picture, files)) + "\">\n";
  }
  const std::string title = escape_html(page.title), json = script_json(data), licence = escape_html(between(arete_page_licence, arete_page_licence_end));
  const std::string three = base64_of(deflate_bytes(std::as_bytes(std::span(arete_page_three, arete_page_three_end))));
  const std::string html = fill_in(between(arete_page_html, arete_page_html_end),
                                   {{"@TITLE@", title},
                                    {"@STYLE@", between(arete_page_css, arete_page_css_end)},
                                    {"@LICENCE@", licence},
                                    {"@THREE@", three},
                                    {"@PAGE@", json},
                                    {"@TERRAINS@", elements},
                                    {"@SCRIPT@", between(arete_page_js, arete_page_js_end)}});
  std::ofstream file(files.staged(), std::ios::binary);
  file << html << std::flush;
  if (!file) throw Error(ErrorKind::disk, "cannot write '" + path + "': " + std::strerror(errno));
  file.close();
  files.publish();
}

}  // namespace arete
