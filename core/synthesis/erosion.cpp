#include "core/synthesis/erosion.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "core/support/parallel.h"
#include "core/support/random.h"

namespace arete {
namespace {

struct Step {
  int x, y;
  double length;  // in cells
};

constexpr double diagonal = std::numbers::sqrt2;
constexpr std::array<Step, 8> steps_around = {{{1, 0, 1}, {-1, 0, 1}, {0, 1, 1}, {0, -1, 1},
                                               {1, 1, diagonal}, {-1, 1, diagonal}, {1, -1, diagonal}, {-1, -1, diagonal}}};

std::int64_t wrap(std::int64_t i, std::int64_t n) { return i < 0 ? i + n : i >= n ? i - n : i; }

/// Where each cell's water goes, and the cells in an order in which every cell comes after the one it drains to.
struct Drainage {
  std::vector<std::int64_t> receiver;  // the cell itself at an outlet
  std::vector<float> distance;         // to the receiver, in cells
  std::vector<std::int64_t> upwards;
};

/// Floods the terrain from the outlets: each cell is reached first over the lowest way. The order of the flood is `upwards`,
/// and the cell that it was reached from is a receiver that never leads into a pit.
Drainage flood(RasterView<const float> terrain, RasterView<const unsigned char> outlet) {
  const std::int64_t width = terrain.width, cells = terrain.size().cells();
  Drainage drainage{std::vector<std::int64_t>(static_cast<std::size_t>(cells), -1),
                    std::vector<float>(static_cast<std::size_t>(cells), 1), {}};
  drainage.upwards.reserve(static_cast<std::size_t>(cells));
  using Front = std::pair<float, std::int64_t>;  // equal heights go by position, so that the order is certain
  std::priority_queue<Front, std::vector<Front>, std::greater<>> front;
  for (std::int64_t i = 0; i < cells; ++i)
    if (outlet(i % width, i / width) != 0) {
      drainage.receiver[static_cast<std::size_t>(i)] = i;
      front.emplace(terrain(i % width, i / width), i);
    }
  while (!front.empty()) {
    const auto [level, i] = front.top();
    front.pop();
    drainage.upwards.push_back(i);
    for (const Step& step : steps_around) {
      const std::int64_t x = wrap(i % width + step.x, width), y = wrap(i / width + step.y, terrain.height);
      const auto n = static_cast<std::size_t>(y * width + x);
      if (drainage.receiver[n] >= 0) continue;
      drainage.receiver[n] = i;
      drainage.distance[n] = static_cast<float>(step.length);
      front.emplace(std::max(level, terrain(x, y)), y * width + x);
    }
  }
  return drainage;
}

/// Turns each cell's water down its steepest slope where there is one: the flood order stays valid, because a lower cell that
/// is not in a pit was flooded before.
void steepen(RasterView<const float> terrain, std::uint64_t seed, Drainage& drainage) {
  const std::int64_t width = terrain.width;
  std::vector<std::int64_t> rank(drainage.upwards.size());
  for (std::size_t k = 0; k < drainage.upwards.size(); ++k)
    rank[static_cast<std::size_t>(drainage.upwards[k])] = static_cast<std::int64_t>(k);
  for (const std::int64_t i : drainage.upwards) {
    const auto here = static_cast<std::size_t>(i);
    if (drainage.receiver[here] == i) continue;
    const double height = terrain(i % width, i / width);
    double steepest = 0;
    for (const Step& step : steps_around) {
      const std::int64_t x = wrap(i % width + step.x, width), y = wrap(i / width + step.y, terrain.height);
      double slope = height - terrain(x, y);
      if (slope > 0 && step.length > 1)
        slope /= 2 - uniform_at(seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(&step - steps_around.data()));
      if (slope <= steepest || rank[static_cast<std::size_t>(y * width + x)] > rank[here]) continue;
      steepest = slope;
      drainage.receiver[here] = y * width + x;
      drainage.distance[here] = static_cast<float>(step.length);
    }
  }
}

}  // namespace

void erode_by_streams(RasterView<float> terrain, RasterView<const float> uplift, RasterView<const unsigned char> outlet,
                      const StreamErosionOptions& options) {
  assert(terrain.size() == uplift.size() && terrain.size() == outlet.size());
  const std::int64_t width = terrain.width;
  const double cell_area = options.cell_size_m * options.cell_size_m;
  std::vector<double> area(static_cast<std::size_t>(terrain.size().cells()));
  for (int step = 0; step < options.steps; ++step) {
    Drainage drainage = flood(terrain, outlet);
    steepen(terrain, hash_position(options.seed, static_cast<std::uint64_t>(step)), drainage);

    std::fill(area.begin(), area.end(), cell_area);
    for (auto i = drainage.upwards.rbegin(); i != drainage.upwards.rend(); ++i) {
      const auto here = static_cast<std::size_t>(*i);
      if (drainage.receiver[here] != *i) area[static_cast<std::size_t>(drainage.receiver[here])] += area[here];
    }
    for (const std::int64_t i : drainage.upwards) {
      const auto here = static_cast<std::size_t>(i);
      const std::int64_t to = drainage.receiver[here];
      if (to == i) continue;
      float& height = terrain(i % width, i / width);
      const double below = terrain(to % width, to / width);
      const double raised = height + uplift(i % width, i / width) * options.step_years;
      const double run = drainage.distance[here] * options.cell_size_m;
      const double share = options.erodibility * options.step_years * std::pow(std::max(area[here], options.least_area_m2), options.area_exponent) / run;
      // Water that stands in a pit does not erode uphill.
      height = static_cast<float>(raised > below ? (raised + share * below) / (1 + share) : raised);
    }
  }
}

void settle_slopes(RasterView<float> terrain, const TalusOptions& options) {
  // An eighth of the excess to each of eight neighbours cannot overshoot; both ends of a slide compute the same amount.
  constexpr double share = 1.0 / 8;
  Raster<float> before(terrain.width, terrain.height);
  for (int step = 0; step < options.steps; ++step) {
    for (std::int64_t y = 0; y < terrain.height; ++y) std::copy_n(terrain.row(y), terrain.width, before.view().row(y));
    parallel_for(terrain.height, options.threads, [&](std::int64_t y) {
      for (std::int64_t x = 0; x < terrain.width; ++x) {
        double change = 0;
        for (const Step& around : steps_around) {
          const double rise = static_cast<double>(before(wrap(x + around.x, terrain.width), wrap(y + around.y, terrain.height))) -
                              before(x, y);
          const double kept = options.talus_slope * options.cell_size_m * around.length;
          if (std::abs(rise) > kept) change += share * (rise > 0 ? rise - kept : rise + kept);
        }
        terrain(x, y) = static_cast<float>(before(x, y) + change);
      }
    });
  }
}

}  // namespace arete
