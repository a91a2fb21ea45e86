#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/support/checksum.h"
#include "core/tree/elevation_tree.h"

namespace arete {

inline std::string golden_number(double value) {
  if (std::isnan(value)) return "void";
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/// A level in one line: size, CRC-32 of the stored values as little-endian doubles (voids as the NaN 0x7ff8000000000000), and
/// the values of four cells.
inline std::string describe_level(const ElevationTree& tree, int level) {
  const Size size = tree.level_size(level);
  Raster<double> cells(size.width, size.height);
  tree.read_stored(level, {0, 0, size.width, size.height}, cells.view());
  for (std::int64_t i = 0; i < size.cells(); ++i)
    if (std::isnan(cells.data()[i])) cells.data()[i] = std::bit_cast<double>(std::uint64_t{0x7ff8000000000000});
  char crc[9];
  std::snprintf(crc, sizeof crc, "%08x", crc32_of(std::as_bytes(std::span(cells.data(), static_cast<std::size_t>(size.cells())))));
  std::string line = "  level " + std::to_string(level) + ": " + std::to_string(size.width) + " x " + std::to_string(size.height) + ", CRC " + crc + ",";
  const std::int64_t places[4][2] = {{0, 0}, {size.width / 2, size.height / 2}, {size.width - 1, size.height / 3}, {size.width - 1, size.height - 1}};
  for (const auto& [x, y] : places) line += " " + golden_number(cells(x, y));
  return line + "\n";
}

/// All that a tree says and holds, as text: what tests/golden/expected.txt has for each golden file, and what the independent decoder
/// prints as well (tests/golden/print_trees.py).
inline std::string describe_tree(const ElevationTree& tree, const std::string& name) {
  const TreeHeader& about = tree.header();
  const auto count = [](auto value) { return std::to_string(static_cast<long long>(value)); };
  std::string text = name + ": coder " + count(about.coder) + ", type " + count(about.type) + ", " + count(about.grid.size().width) + " x " +
                     count(about.grid.size().height) + ", nodes of " + count(about.grid.side()) + ", voids " + count(about.voids) + "\n";
  text += "  scale " + golden_number(about.scale) + ", offset " + golden_number(about.offset) + ", unit " + about.geo.vertical_unit + " of " +
          golden_number(about.geo.metres_per_unit) + " m, point " + count(about.geo.registration == Registration::point) + "\n  transform";
  if (!about.geo.transform) text += " none";
  if (about.geo.transform)
    for (double number : *about.geo.transform) text += " " + golden_number(number);
  text += "\n  nodata " + (about.geo.nodata ? golden_number(*about.geo.nodata) : "none") + ", claim " + count(about.claim) + " of " + golden_number(about.claimed) + "\n";
  text += "  crs " + about.geo.crs_wkt + ", band " + about.band_name + "\n";
  for (const auto& [key, value] : about.metadata) text += "  item " + key + " = " + value + "\n";
  for (int level = 0; level <= tree.levels(); ++level) text += describe_level(tree, level);
  return text;
}

}  // namespace arete
