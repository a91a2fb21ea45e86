#include "gis/tin/tile_border.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gis/tin/heights.h"

namespace arete {
namespace {

/// The line between two cells, and half a cell beyond the last valid one at its value.
double interpolate(std::span<const float> cells, std::int32_t at, int units) {
  const std::int32_t i = at >= 0 ? at / units : -1, rest = at - i * units;
  const auto valid = [&](std::int32_t k) { return k >= 0 && k < static_cast<std::int32_t>(cells.size()) && !std::isnan(cells[k]); };
  if (rest == 0 || !valid(i + 1)) return cells[i];
  if (!valid(i)) return cells[i + 1];
  return cells[i] + (static_cast<double>(cells[i + 1]) - cells[i]) * rest / units;
}

class Tunnel {
 public:
  Tunnel(std::span<const float> cells, const LineBound& bound) : cells_(cells), bound_(bound) {}

  /// Appends vertices to a polyline from its last one to `end`.
  void follow(Polyline& line, const LineVertex& end) const {
    while (line.back() != end) line.push_back(next(line.back(), end));
  }

 private:
  /// Whether the side keeps the bound at the cells inside it.
  bool keeps(const LineVertex& from, const LineVertex& to) const {
    const double length = to.at - from.at;
    for (std::int32_t cell = from.at / bound_.units + 1; cell * bound_.units < to.at; ++cell) {
      const double height = from.z * (to.at - cell * bound_.units) + to.z * (cell * bound_.units - from.at);
      if (std::abs(height - length * cells_[cell]) > length * bound_.error_m) return false;
    }
    return true;
  }

  LineVertex next(const LineVertex& from, const LineVertex& end) const {
    // The slopes at which a side passes all cells so far.
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    std::vector<LineVertex> reached;
    const double longest = bound_.longest_cells * bound_.units;
    std::int32_t cell = from.at >= 0 ? from.at / bound_.units + 1 : 0;
    for (; cell * bound_.units < end.at; ++cell) {
      const double run = cell * bound_.units - from.at;
      if (run > longest && !reached.empty()) break;
      low = std::max(low, (cells_[cell] - bound_.error_m - from.z) / run);
      high = std::min(high, (cells_[cell] + bound_.error_m - from.z) / run);
      if (low > high) break;
      const double slope = std::clamp((cells_[cell] - from.z) / run, low, high);
      reached.push_back({cell * bound_.units, round_height(from.z + slope * run, bound_.height_step_m)});
    }
    if (cell * bound_.units >= end.at && (end.at - from.at <= longest || reached.empty()) && keeps(from, end)) return end;
    // Rounding may have left the tunnel: then the vertex before is taken.
    while (reached.size() > 1 && !(keeps(from, reached.back()) && within(reached.back()))) reached.pop_back();
    if (reached.empty()) return end;
    if (!within(reached.back())) reached.back().z = round_height(cells_[reached.back().at / bound_.units], bound_.height_step_m);
    return reached.back();
  }

  bool within(const LineVertex& vertex) const {
    return std::abs(vertex.z - cells_[vertex.at / bound_.units]) <= bound_.error_m;
  }

  std::span<const float> cells_;
  const LineBound& bound_;
};

}  // namespace

std::vector<Polyline> simplify_line(std::span<const float> cells, const LineBound& bound, std::span<const std::int32_t> forced) {
  std::vector<Polyline> lines;
  const Tunnel tunnel(cells, bound);
  const auto count = static_cast<std::int32_t>(cells.size());
  const auto vertex_at = [&](std::int32_t at) { return LineVertex{at, round_height(interpolate(cells, at, bound.units), bound.height_step_m)}; };
  for (std::int32_t first = 0; first < count;) {
    if (std::isnan(cells[first])) {
      ++first;
      continue;
    }
    std::int32_t last = first;
    while (last + 1 < count && !std::isnan(cells[last + 1])) ++last;
    const std::int32_t start = first == 0 ? 0 : first * bound.units - bound.units / 2;
    const std::int32_t end = last == count - 1 ? last * bound.units : last * bound.units + bound.units / 2;
    Polyline line{vertex_at(start)};
    for (const std::int32_t at : forced)
      if (at > start && at < end) tunnel.follow(line, vertex_at(at));
    if (end > start) {
      tunnel.follow(line, vertex_at(end));
      lines.push_back(std::move(line));
    }
    first = last + 1;
  }
  return lines;
}

double height_at(const Polyline& line, std::int32_t at) {
  const auto next = std::lower_bound(line.begin(), line.end(), at, [](const LineVertex& v, std::int32_t place) { return v.at < place; });
  if (next->at == at) return next->z;
  const auto before = next - 1;
  return (before->z * (next->at - at) + next->z * (at - before->at)) / (next->at - before->at);
}

}  // namespace arete
