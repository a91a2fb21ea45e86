#include "gis/mesh/terrain_layer.h"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "core/support/error.h"

namespace arete {
namespace {

using nlohmann::json;

constexpr int most_levels = 31;

[[noreturn]] void fail(const std::string& name, const std::string& reason) {
  throw Error(ErrorKind::input, "'" + name + "' describes no set of terrain tiles: " + reason);
}

TerrainTileBlock parse_block(const json& block, int level, const std::string& name) {
  const TerrainTileBlock b{block.at("startX"), block.at("startY"), block.at("endX"), block.at("endY")};
  const std::int64_t rows = std::int64_t{1} << level;
  if (b.x0 < 0 || b.y0 < 0 || b.x1 < b.x0 || b.y1 < b.y0 || b.x1 >= 2 * rows || b.y1 >= rows) fail(name, "level " + std::to_string(level) + " has no tiles " + block.dump());
  return b;
}

}  // namespace

std::vector<TerrainTileBlock> blocks_of(const std::set<std::pair<std::int64_t, std::int64_t>>& tiles) {
  std::map<std::int64_t, std::vector<std::int64_t>> rows;
  for (const auto& [x, y] : tiles) rows[y].push_back(x);
  std::vector<TerrainTileBlock> done;
  std::map<std::pair<std::int64_t, std::int64_t>, TerrainTileBlock> open;  // by columns; they end in the row before
  for (const auto& [y, columns] : rows) {
    std::map<std::pair<std::int64_t, std::int64_t>, TerrainTileBlock> next;
    for (std::size_t i = 0; i < columns.size();) {
      std::size_t end = i + 1;
      while (end < columns.size() && columns[end] == columns[end - 1] + 1) ++end;
      const std::pair run{columns[i], columns[end - 1]};
      const auto above = open.find(run);
      const bool joins = above != open.end() && above->second.y1 + 1 == y;
      next[run] = {run.first, joins ? above->second.y0 : y, run.second, y};
      if (joins) open.erase(above);
      i = end;
    }
    for (const auto& [run, block] : open) done.push_back(block);
    open = std::move(next);
  }
  for (const auto& [run, block] : open) done.push_back(block);
  std::sort(done.begin(), done.end(), [](const auto& a, const auto& b) { return std::pair(a.y0, a.x0) < std::pair(b.y0, b.x0); });
  return done;
}

std::string describe_layer(const TerrainLayer& layer) {
  json available = json::array();
  for (const std::vector<TerrainTileBlock>& level : layer.available) {
    json blocks = json::array();
    for (const TerrainTileBlock& b : level) blocks.push_back({{"startX", b.x0}, {"startY", b.y0}, {"endX", b.x1}, {"endY", b.y1}});
    available.push_back(std::move(blocks));
  }
  const TileRectangle& r = layer.bounds;
  const json text = {{"tilejson", "2.1.0"}, {"format", "quantized-mesh-1.0"}, {"version", "1.0.0"}, {"name", layer.name}, {"description", ""},
                     {"attribution", ""}, {"scheme", "tms"}, {"projection", "EPSG:4326"}, {"tiles", {"{z}/{x}/{y}.terrain"}}, {"extensions", json::array()},
                     {"bounds", {r.west, r.south, r.east, r.north}}, {"minzoom", 0}, {"maxzoom", layer.available.size() - 1}, {"available", available},
                     {"arete", {{"filled", layer.filled}}}};
  return text.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

TerrainLayer parse_layer(const std::string& text, const std::string& name) {
  const json parsed = json::parse(text, nullptr, false);
  if (!parsed.is_object()) fail(name, "expected a JSON object");
  try {
    const auto is = [&](const char* key, const char* expected) {
      if (parsed.value(key, expected) != expected) fail(name, std::string(key) + " is " + parsed.at(key).dump() + ", expected " + expected);
    };
    if (!parsed.contains("format")) fail(name, "it names no format");
    is("format", "quantized-mesh-1.0"), is("scheme", "tms"), is("projection", "EPSG:4326");
    TerrainLayer layer;
    layer.name = parsed.value("name", "");
    const auto bounds = parsed.value("bounds", std::vector<double>{-180, -90, 180, 90});
    if (bounds.size() != 4) fail(name, "its bounds are not four numbers");
    layer.bounds = {bounds[0], bounds[1], bounds[2], bounds[3]};
    const json& available = parsed.at("available");
    if (!available.is_array() || available.empty() || available.size() > most_levels) fail(name, "expected available tiles for 1 to 31 levels");
    for (const json& level : available) {
      std::vector<TerrainTileBlock> blocks;
      for (const json& block : level) blocks.push_back(parse_block(block, static_cast<int>(layer.available.size()), name));
      layer.available.push_back(std::move(blocks));
    }
    layer.filled = parsed.contains("arete") && parsed["arete"].value("filled", false);
    return layer;
  } catch (const json::exception& error) {
    fail(name, error.what());
  }
}

std::string terrain_tile_path(const std::string& folder, int level, std::int64_t x, std::int64_t y) {
  return folder + "/" + std::to_string(level) + "/" + std::to_string(x) + "/" + std::to_string(y) + ".terrain";
}

}  // namespace arete
