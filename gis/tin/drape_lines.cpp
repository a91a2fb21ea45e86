// Douglas, D. H., Peucker, T. K.: Algorithms for the reduction of the number of points required to represent a digitized line. 1973.
#include "gis/tin/drape_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace arete {
namespace {

/// The part of a straight line within a tile.
struct Part {
  std::size_t row, column;  // of the tile
  std::size_t line, side;   // line of all, from its vertex `side`
  double first, last;       // 0 at that vertex, 1 at the next

  bool operator<(const Part& other) const { return std::tie(row, column, line, side) < std::tie(other.row, other.column, other.line, other.side); }
};

using Interval = std::array<double, 2>;

/// Where a line from a to b lies between low and high along axis k.
std::optional<Interval> within(const RasterPlace& a, const RasterPlace& b, std::size_t k, double low, double high, Interval part) {
  const double run = b[k] - a[k];
  if (run == 0) return a[k] < low || a[k] > high ? std::nullopt : std::optional(part);
  const double t = (low - a[k]) / run, u = (high - a[k]) / run;
  part = {std::max(part[0], std::min(t, u)), std::min(part[1], std::max(t, u))};
  return part[0] < part[1] ? std::optional(part) : std::nullopt;
}

void append_parts(const RasterLine& line, std::size_t index, std::span<const std::int64_t> columns, std::span<const std::int64_t> rows, std::vector<Part>& parts) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
      const auto in_row = within(line[i], line[i + 1], 1, static_cast<double>(rows[row]), static_cast<double>(rows[row + 1]), {0, 1});
      if (!in_row) continue;
      for (std::size_t column = 0; column + 1 < columns.size(); ++column)
        if (const auto in_tile = within(line[i], line[i + 1], 0, static_cast<double>(columns[column]), static_cast<double>(columns[column + 1]), *in_row))
          parts.push_back({row, column, index, i, (*in_tile)[0], (*in_tile)[1]});
    }
}

/// Chooses samples of a profile between two that are there, until none is too far off.
void choose(std::span<const double> heights, std::size_t first, std::size_t last, double error_m, std::vector<std::size_t>& chosen) {
  std::vector<std::pair<std::size_t, std::size_t>> stack{{first, last}};
  while (!stack.empty()) {
    const auto [from, to] = stack.back();
    stack.pop_back();
    std::size_t worst = from;
    double most = error_m;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      const double off = std::abs(heights[i] - (heights[from] + share * (heights[to] - heights[from])));
      if (off > most) most = off, worst = i;
    }
    if (worst == from) continue;
    chosen.push_back(worst);
    stack.emplace_back(from, worst);
    stack.emplace_back(worst, to);
  }
}

/// Where vertices are needed within a part.
std::vector<double> places_in(const Part& part, const RasterPlace& a, const RasterPlace& b, RasterView<const float> cells, const RasterPlace& corner, double error_m,
                              double longest_cells) {
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]) * (part.last - part.first);
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(2 * length)));
  const auto at = [&](std::size_t i) { return part.first + (part.last - part.first) * static_cast<double>(i) / static_cast<double>(steps); };
  std::vector<double> heights;
  for (std::size_t i = 0; i <= steps; ++i)
    heights.push_back(height_between(cells, a[0] + at(i) * (b[0] - a[0]) - corner[0], a[1] + at(i) * (b[1] - a[1]) - corner[1]));
  const auto stride = static_cast<std::size_t>(std::min(1.9 * longest_cells, static_cast<double>(steps)));  // of half cells, a little less than the longest
  std::vector<std::size_t> chosen;
  for (std::size_t first = 0; first <= steps;) {
    std::size_t last = first;
    while (last < steps && !std::isnan(heights[last]) && !std::isnan(heights[last + 1])) ++last;
    for (std::size_t from = first; from < last; from += stride) {
      const std::size_t to = std::min(last, from + stride);
      if (to < last) chosen.push_back(to);
      choose(heights, from, to, error_m, chosen);
    }
    first = last + 1;
  }
  std::vector<double> places;
  for (const std::size_t i : chosen) places.push_back(at(i));
  return places;
}

}  // namespace

double height_between(RasterView<const float> cells, double column, double row) {
  const auto x = std::clamp(static_cast<std::int64_t>(std::floor(column)), std::int64_t{0}, cells.width - 1);
  const auto y = std::clamp(static_cast<std::int64_t>(std::floor(row)), std::int64_t{0}, cells.height - 1);
  const double right = std::clamp(column - static_cast<double>(x), 0.0, 1.0), down = std::clamp(row - static_cast<double>(y), 0.0, 1.0);
  double sum = 0, weights = 0;
  for (const std::int64_t dx : {0, 1})
    for (const std::int64_t dy : {0, 1}) {
      const double weight = (dx ? right : 1 - right) * (dy ? down : 1 - down);
      if (weight == 0 || x + dx >= cells.width || y + dy >= cells.height || is_void(cells(x + dx, y + dy))) continue;
      sum += weight * cells(x + dx, y + dy);
      weights += weight;
    }
  return weights > 0 ? sum / weights : std::nan("");
}

TinLines drape_lines(const RasterSource& raster, const TinLines& lines, std::span<const std::int64_t> columns, std::span<const std::int64_t> rows, double error_m,
                     double longest_cells) {
  std::vector<const RasterLine*> all;
  for (const RasterLine& line : lines.breaklines) all.push_back(&line);
  for (const RasterLine& ring : lines.boundary) all.push_back(&ring);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < all.size(); ++i) append_parts(*all[i], i, columns, rows, parts);
  std::sort(parts.begin(), parts.end());

  std::vector<std::vector<std::pair<std::size_t, double>>> places(all.size());  // of each line: side, place along it
  Raster<float> cells;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    if (i == 0 || part.row != parts[i - 1].row || part.column != parts[i - 1].column) {
      const Window window{columns[part.column], rows[part.row], columns[part.column + 1] - columns[part.column] + 1, rows[part.row + 1] - rows[part.row] + 1};
      cells = Raster<float>(window.width, window.height);
      raster.read(window, cells.view());
    }
    const RasterLine& line = *all[part.line];
    const RasterPlace corner{static_cast<double>(columns[part.column]), static_cast<double>(rows[part.row])};
    for (const double t : places_in(part, line[part.side], line[part.side + 1], std::as_const(cells).view(), corner, error_m, longest_cells))
      places[part.line].emplace_back(part.side, t);
  }

  TinLines draped;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::sort(places[i].begin(), places[i].end());
    RasterLine& line = i < lines.breaklines.size() ? draped.breaklines.emplace_back() : draped.boundary.emplace_back();
    auto next = places[i].begin();
    for (std::size_t k = 0; k < all[i]->size(); ++k) {
      const RasterPlace& a = (*all[i])[k];
      line.push_back(a);
      for (; next != places[i].end() && next->first == k; ++next) {
        const RasterPlace& b = (*all[i])[k + 1];
        line.push_back({a[0] + next->second * (b[0] - a[0]), a[1] + next->second * (b[1] - a[1])});
      }
    }
  }
  return draped;
}

}  // namespace arete
