#include "gis/tin/constraint_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/support/error.h"

namespace arete {
namespace {

using Place = std::array<std::int64_t, 2>;
using Segment = LineArrangement::Segment;
__extension__ using Wide = __int128;

constexpr std::int64_t half_cell = line_units / 2;
constexpr std::int64_t bin_units = std::int64_t{4} * line_units;
constexpr int most_rounds = 100;

std::int64_t nearest_multiple(std::int64_t value, std::int64_t step) {
  const std::int64_t shifted = value + step / 2;
  return (shifted >= 0 ? shifted / step : -((-shifted + step - 1) / step)) * step;
}

std::int64_t rounded_quotient(Wide numerator, Wide denominator) {
  if (denominator < 0) numerator = -numerator, denominator = -denominator;
  const Wide twice = 2 * numerator + denominator, whole = 2 * denominator;
  Wide quotient = twice / whole;
  if (twice < 0 && quotient * whole != twice) --quotient;
  return static_cast<std::int64_t>(quotient);
}

/// The first of the borders that is not below a place, as an index; the borders ascend.
std::size_t tile_of(std::span<const std::int64_t> edges, std::int64_t twice_units) {
  const auto after = std::upper_bound(edges.begin(), edges.end(), twice_units, [](std::int64_t value, std::int64_t cell) { return value < 2 * cell * line_units; });
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - edges.begin() - 1, 0, static_cast<std::ptrdiff_t>(edges.size()) - 2));
}

bool is_border(std::span<const std::int64_t> edges, std::int64_t units) {
  return units % line_units == 0 && std::binary_search(edges.begin(), edges.end(), units / line_units);
}

/// Snaps and cuts until nothing is left to cut. Ends lie on a grid of pixels; a segment that passes the pixel of an end, or of a half-cell place, is
/// led through its centre.
class Snapper {
 public:
  Snapper(std::span<const std::int64_t> columns, std::span<const std::int64_t> rows, std::int64_t pixel) : columns_(columns), rows_(rows), pixel_(pixel) {}

  void add(const RasterLine& line, bool boundary) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      const std::optional<std::array<RasterPlace, 2>> part = clip(line[i - 1], line[i]);
      if (part) push(segments_, snap((*part)[0]), snap((*part)[1]), !boundary, boundary);
    }
  }

  std::vector<Segment> cut() {
    for (int round = 0; round < most_rounds; ++round) {
      merge();
      while (cut_at_borders()) merge();
      if (!cut_once()) return std::move(segments_);
    }
    throw Error(ErrorKind::input, "the lines are too tangled to be cut where they cross within 1/65536 of a cell: simplify them first");
  }

 private:
  /// The part of a segment near the rectangle of the outermost centres.
  std::optional<std::array<RasterPlace, 2>> clip(const RasterPlace& a, const RasterPlace& b) const {
    double first = 0, last = 1;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::span<const std::int64_t> edges = k == 0 ? columns_ : rows_;
      const double low = static_cast<double>(edges.front()) - 2, high = static_cast<double>(edges.back()) + 2, run = b[k] - a[k];
      if (run == 0) {
        if (a[k] < low || a[k] > high) return std::nullopt;
        continue;
      }
      const double t = (low - a[k]) / run, u = (high - a[k]) / run;
      first = std::max(first, std::min(t, u)), last = std::min(last, std::max(t, u));
    }
    if (first > last) return std::nullopt;
    const auto at = [&](double t) { return t == 0 ? a : t == 1 ? b : RasterPlace{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])}; };
    return std::array<RasterPlace, 2>{at(first), at(last)};
  }

  std::int64_t snap(std::int64_t units) const { return nearest_multiple(units, pixel_); }
  Place snap(const RasterPlace& place) const { return {snap(std::llround(place[0] * line_units)), snap(std::llround(place[1] * line_units))}; }

  static void push(std::vector<Segment>& segments, const Place& a, const Place& b, bool breakline, bool boundary) {
    if (a != b) segments.push_back({std::min(a, b), std::max(a, b), breakline, boundary});
  }

  /// One segment of those that are equal. Two sides of the boundary on the same place are none.
  void merge() {
    std::sort(segments_.begin(), segments_.end(), [](const Segment& a, const Segment& b) { return std::pair(a.from, a.to) < std::pair(b.from, b.to); });
    std::vector<Segment> merged;
    for (const Segment& s : segments_) {
      if (!merged.empty() && merged.back().from == s.from && merged.back().to == s.to) {
        merged.back().breakline |= s.breakline;
        merged.back().boundary ^= s.boundary;
      } else {
        if (!merged.empty() && !merged.back().breakline && !merged.back().boundary) merged.pop_back();
        merged.push_back(s);
      }
    }
    if (!merged.empty() && !merged.back().breakline && !merged.back().boundary) merged.pop_back();
    segments_ = std::move(merged);
  }

  bool outside(const Segment& s) const {
    const auto beyond = [](std::int64_t a, std::int64_t b, std::span<const std::int64_t> edges) {
      return std::max(a, b) <= edges.front() * line_units ? std::min(a, b) < edges.front() * line_units
                                                          : std::min(a, b) >= edges.back() * line_units && std::max(a, b) > edges.back() * line_units;
    };
    return beyond(s.from[0], s.to[0], columns_) || beyond(s.from[1], s.to[1], rows_);
  }

  bool cut_at_borders() {
    std::vector<std::vector<Place>> cuts(segments_.size());
    bool any = false;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const Segment& s = segments_[i];
        const std::int64_t low = std::min(s.from[k], s.to[k]), high = std::max(s.from[k], s.to[k]), run = s.to[k] - s.from[k];
        for (const std::int64_t cell : k == 0 ? columns_ : rows_) {
          const std::int64_t at = cell * line_units;
          if (at <= low || at >= high) continue;
          Place cut;
          cut[k] = at;
          cut[1 - k] = s.from[1 - k] + pixel_ * rounded_quotient(static_cast<Wide>(s.to[1 - k] - s.from[1 - k]) * (at - s.from[k]), static_cast<Wide>(run) * pixel_);
          cuts[i].push_back(cut);
          any = true;
        }
      }
    }
    if (any) apply(cuts);
    const std::size_t before = segments_.size();
    std::erase_if(segments_, [&](const Segment& s) { return outside(s); });
    return any || segments_.size() < before;
  }

  /// Replaces segments by chains through the places where they are cut.
  void apply(std::vector<std::vector<Place>>& cuts) {
    std::vector<Segment> pieces;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const Segment& s = segments_[i];
      const std::int64_t sign = s.to[1] >= s.from[1] ? 1 : -1;  // from < to: x does not fall
      const auto along = [&](const Place& p) { return p[0] + sign * p[1]; };
      std::sort(cuts[i].begin(), cuts[i].end(), [&](const Place& a, const Place& b) { return std::pair(along(a), a) < std::pair(along(b), b); });
      Place last = s.from;
      for (const Place& cut : cuts[i]) {
        // Two that are as far lie on both sides of a segment through the corner of their pixels: one is enough, and both would lead back.
        if (along(cut) == along(last)) continue;
        push(pieces, last, cut, s.breakline, s.boundary);
        last = cut;
      }
      push(pieces, last, s.to, s.breakline, s.boundary);
    }
    segments_ = std::move(pieces);
  }

  /// Whether a segment passes the pixel of a place that is none of its ends.
  bool passes(const Segment& s, const Place& p) const {
    const std::int64_t dx = s.to[0] - s.from[0], dy = s.to[1] - s.from[1];
    for (std::size_t k = 0; k < 2; ++k)
      if (p[k] < std::min(s.from[k], s.to[k]) || p[k] > std::max(s.from[k], s.to[k])) return false;
    const std::int64_t across = dx * (p[1] - s.from[1]) - dy * (p[0] - s.from[0]);
    return p != s.from && p != s.to && 2 * std::abs(across) <= pixel_ * (std::abs(dx) + std::abs(dy));
  }

  static int side(const Segment& s, const Place& p) {
    const Wide across = static_cast<Wide>(s.to[0] - s.from[0]) * (p[1] - s.from[1]) - static_cast<Wide>(s.to[1] - s.from[1]) * (p[0] - s.from[0]);
    return across > 0 ? 1 : across < 0 ? -1 : 0;
  }

  void look_at_half_cells(const Segment& s, std::vector<Place>& cuts) const {
    const std::size_t k = std::abs(s.to[0] - s.from[0]) >= std::abs(s.to[1] - s.from[1]) ? 0 : 1;
    const std::int64_t low = std::min(s.from[k], s.to[k]), high = std::max(s.from[k], s.to[k]);
    const double slope = static_cast<double>(s.to[1 - k] - s.from[1 - k]) / static_cast<double>(s.to[k] - s.from[k]);
    for (std::int64_t at = nearest_multiple(low, half_cell); at <= high; at += half_cell) {
      Place p;
      p[k] = at;
      p[1 - k] = nearest_multiple(std::llround(static_cast<double>(s.from[1 - k]) + slope * static_cast<double>(at - s.from[k])), half_cell);
      if (passes(s, p)) cuts.push_back(p);
    }
  }

  /// Where two segments cross, to a pixel.
  std::optional<Place> crossing_of(const Segment& s, const Segment& t) const {
    if (side(s, t.from) * side(s, t.to) >= 0 || side(t, s.from) * side(t, s.to) >= 0) return std::nullopt;
    const std::int64_t dx = s.to[0] - s.from[0], dy = s.to[1] - s.from[1], ex = t.to[0] - t.from[0], ey = t.to[1] - t.from[1];
    const Wide whole = static_cast<Wide>(dx) * ey - static_cast<Wide>(dy) * ex;
    const Wide part = static_cast<Wide>(t.from[0] - s.from[0]) * ey - static_cast<Wide>(t.from[1] - s.from[1]) * ex;
    // Rounded once: the pixel has the crossing in it.
    return Place{s.from[0] + pixel_ * rounded_quotient(part * dx, whole * pixel_), s.from[1] + pixel_ * rounded_quotient(part * dy, whole * pixel_)};
  }

  struct Entry {
    std::int64_t row, column;
    std::size_t segment;
    bool operator<(const Entry& other) const { return std::array{row, column, static_cast<std::int64_t>(segment)} < std::array{other.row, other.column, static_cast<std::int64_t>(other.segment)}; }
  };

  /// The squares of bin_units that a segment passes, or nearly.
  void enter(std::size_t index, std::vector<Entry>& entries) const {
    const Segment& s = segments_[index];
    const double margin = static_cast<double>(2 * pixel_);
    const double ax = static_cast<double>(s.from[0]), ay = static_cast<double>(s.from[1]), bx = static_cast<double>(s.to[0]), by = static_cast<double>(s.to[1]);
    const double low = std::min(ay, by) - margin, high = std::max(ay, by) + margin, size = static_cast<double>(bin_units);
    const auto bin = [&](double v) { return static_cast<std::int64_t>(std::floor(v / size)); };
    for (std::int64_t row = bin(low); row <= bin(high); ++row) {
      double first = 0, last = 1;
      if (ay != by) {
        const double t = (static_cast<double>(row) * size - margin - ay) / (by - ay), u = (static_cast<double>(row + 1) * size + margin - ay) / (by - ay);
        first = std::clamp(std::min(t, u), 0.0, 1.0), last = std::clamp(std::max(t, u), 0.0, 1.0);
      }
      const double x = ax + first * (bx - ax), y = ax + last * (bx - ax);
      for (std::int64_t column = bin(std::min(x, y) - margin); column <= bin(std::max(x, y) + margin); ++column) entries.push_back({row, column, index});
    }
  }

  using Hot = std::map<std::array<std::int64_t, 2>, std::vector<Place>>;  // by row and column of bins

  static std::array<std::int64_t, 2> bin_of(const Place& p) {
    const auto bin = [](std::int64_t v) { return v >= 0 ? v / bin_units : -((-v + bin_units - 1) / bin_units); };
    return {bin(p[1]), bin(p[0])};
  }

  /// Ends and crossings.
  Hot find_hot(const std::vector<Entry>& entries) const {
    Hot hot;
    const auto add = [&](const Place& p) { hot[bin_of(p)].push_back(p); };
    for (const Segment& s : segments_) add(s.from), add(s.to);
    for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
      while (last < entries.size() && entries[last].row == entries[first].row && entries[last].column == entries[first].column) ++last;
      for (std::size_t i = first; i < last; ++i)
        for (std::size_t j = i + 1; j < last; ++j)
          if (const std::optional<Place> crossing = crossing_of(segments_[entries[i].segment], segments_[entries[j].segment])) add(*crossing);
    }
    for (auto& [bin, places] : hot) {
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
    }
    return hot;
  }

  /// One round of snap rounding: every segment led through the centres of the pixels that it passes. Whether any was.
  bool lead_through(const Hot& hot) {
    std::vector<std::vector<Place>> cuts(segments_.size());
    std::vector<Entry> bins;
    bool any = false;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      look_at_half_cells(segments_[i], cuts[i]);
      bins.clear();
      enter(i, bins);
      for (const Entry& bin : bins) {
        const auto places = hot.find({bin.row, bin.column});
        if (places == hot.end()) continue;
        for (const Place& p : places->second)
          if (passes(segments_[i], p)) cuts[i].push_back(p);
      }
      std::sort(cuts[i].begin(), cuts[i].end());
      cuts[i].erase(std::unique(cuts[i].begin(), cuts[i].end()), cuts[i].end());
      any |= !cuts[i].empty();
    }
    if (any) apply(cuts);
    return any;
  }

  bool cut_once() {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < segments_.size(); ++i) enter(i, entries);
    std::sort(entries.begin(), entries.end());
    const Hot hot = find_hot(entries);
    bool any = false;
    // Each round makes segments whose bounds are smaller: it ends.
    while (lead_through(hot)) merge(), any = true;
    return any;
  }

  std::span<const std::int64_t> columns_, rows_;
  std::int64_t pixel_;
  std::vector<Segment> segments_;
};

/// Places along a border within a tile, from its first cell.
std::vector<std::int32_t> part_of(const std::map<std::int64_t, std::vector<std::int64_t>>& places, std::int64_t border, std::int64_t first, std::int64_t last) {
  std::vector<std::int32_t> part;
  const auto found = places.find(border * line_units);
  if (found == places.end()) return part;
  for (auto at = std::lower_bound(found->second.begin(), found->second.end(), first * line_units); at != found->second.end() && *at <= last * line_units; ++at)
    part.push_back(static_cast<std::int32_t>(*at - first * line_units));
  return part;
}

void sort_places(std::map<std::int64_t, std::vector<std::int64_t>>& places) {
  for (auto& [border, along] : places) {
    std::sort(along.begin(), along.end());
    along.erase(std::unique(along.begin(), along.end()), along.end());
  }
}

}  // namespace

LineArrangement::LineArrangement(const TinLines& lines, std::span<const std::int64_t> columns, std::span<const std::int64_t> rows, double tolerance_cells)
    : columns_(columns.begin(), columns.end()), rows_(rows.begin(), rows.end()) {
  std::int64_t pixel = 4;
  while (pixel < half_cell / 8 && static_cast<double>(pixel) < 2 * tolerance_cells * line_units) pixel *= 2;
  Snapper snapper(columns_, rows_, pixel);
  for (const RasterLine& line : lines.breaklines) snapper.add(line, false);
  for (const RasterLine& ring : lines.boundary) snapper.add(ring, true);
  segments_ = snapper.cut();
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    for (const Place& p : {s.from, s.to}) {
      if (is_border(columns_, p[0])) on_columns_[p[0]].push_back(p[1]);
      if (is_border(rows_, p[1])) on_rows_[p[1]].push_back(p[0]);
    }
    if ((s.from[0] == s.to[0] && is_border(columns_, s.from[0])) || (s.from[1] == s.to[1] && is_border(rows_, s.from[1]))) continue;
    const std::size_t column = tile_of(columns_, s.from[0] + s.to[0]), row = tile_of(rows_, s.from[1] + s.to[1]);
    of_tiles_[{static_cast<std::int64_t>(row), static_cast<std::int64_t>(column)}].push_back(i);
  }
  sort_places(on_columns_);
  sort_places(on_rows_);
}

TileLines LineArrangement::of_tile(std::size_t column, std::size_t row) const {
  const std::int64_t left = columns_[column], right = columns_[column + 1], top = rows_[row], bottom = rows_[row + 1];
  TileLines tile;
  tile.top = part_of(on_rows_, top, left, right), tile.bottom = part_of(on_rows_, bottom, left, right);
  tile.left = part_of(on_columns_, left, top, bottom), tile.right = part_of(on_columns_, right, top, bottom);
  const auto found = of_tiles_.find({static_cast<std::int64_t>(row), static_cast<std::int64_t>(column)});
  if (found == of_tiles_.end()) return tile;
  const auto local = [&](const Place& p) {
    return std::array{static_cast<std::int32_t>(p[0] - left * line_units), static_cast<std::int32_t>(p[1] - top * line_units)};
  };
  for (const std::size_t i : found->second) tile.pieces.push_back({local(segments_[i].from), local(segments_[i].to), segments_[i].boundary});
  return tile;
}

bool is_inside(std::span<const RasterLine> rings, const RasterPlace& place) {
  bool inside = false;
  for (const RasterLine& ring : rings)
    for (std::size_t i = 1; i < ring.size(); ++i) {
      const RasterPlace &a = ring[i - 1], &b = ring[i];
      if ((a[1] > place[1]) == (b[1] > place[1])) continue;
      if (a[0] + (place[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > place[0]) inside = !inside;
    }
  return inside;
}

}  // namespace arete
