#include "core/synthesis/erosion.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <queue>
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
  std::vector<std::uint32_t> rank;     // of a cell in `upwards`
};

constexpr std::uint32_t not_flooded = 0xffffffff;

/// A height and a cell in one number that orders as they do, equal heights by position: bits of a float order as its values do when
/// those of negative ones are turned.
std::uint64_t front_key(float height, std::int64_t cell) {
  const auto bits = std::bit_cast<std::uint32_t>(height);
  const std::uint32_t ordered = (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
  return std::uint64_t{ordered} << 32 | static_cast<std::uint64_t>(cell);
}

/// Floods the terrain from the outlets: each cell is reached first over the lowest way. The order of the flood is `upwards`,
/// and the cell that it was reached from is a receiver that never leads into a pit.
Drainage flood(RasterView<const float> terrain, RasterView<const unsigned char> outlet) {
  const std::int64_t width = terrain.width, cells = terrain.size().cells();
  const auto count = static_cast<std::size_t>(cells);
  Drainage drainage{std::vector<std::int64_t>(count, -1), std::vector<float>(count, 1), {}, std::vector<std::uint32_t>(count, not_flooded)};
  drainage.upwards.reserve(count);
  std::vector<float> level(count);  // of the water over each cell
  std::priority_queue<std::uint64_t, std::vector<std::uint64_t>, std::greater<>> front;
  for (std::int64_t i = 0; i < cells; ++i)
    if (outlet(i % width, i / width) != 0) {
      drainage.receiver[static_cast<std::size_t>(i)] = i;
      level[static_cast<std::size_t>(i)] = terrain(i % width, i / width);
      front.push(front_key(terrain(i % width, i / width), i));
    }
  while (!front.empty()) {
    const auto i = static_cast<std::int64_t>(front.top() & 0xffffffffu);
    front.pop();
    drainage.rank[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(drainage.upwards.size());
    drainage.upwards.push_back(i);
    const std::int64_t x0 = i % width, y0 = i / width;
    for (const Step& step : steps_around) {
      const std::int64_t x = wrap(x0 + step.x, width), y = wrap(y0 + step.y, terrain.height);
      const auto n = static_cast<std::size_t>(y * width + x);
      if (drainage.receiver[n] >= 0) continue;
      drainage.receiver[n] = i;
      drainage.distance[n] = static_cast<float>(step.length);
      level[n] = std::max(level[static_cast<std::size_t>(i)], terrain(x, y));
      front.push(front_key(level[n], y * width + x));
    }
  }
  return drainage;
}

/// Turns each cell's water down its steepest slope where there is one: the flood order stays valid, because a lower cell that
/// is not in a pit was flooded before.
void steepen(RasterView<const float> terrain, std::uint64_t seed, int threads, Drainage& drainage) {
  const std::int64_t width = terrain.width;
  parallel_for(terrain.height, threads, [&](std::int64_t y0) {
    for (std::int64_t x0 = 0; x0 < width; ++x0) {
      const std::int64_t i = y0 * width + x0;
      const auto here = static_cast<std::size_t>(i);
      if (drainage.receiver[here] == i) continue;
      const float height = terrain(x0, y0);
      double steepest = 0;
      for (const Step& step : steps_around) {
        const std::int64_t x = wrap(x0 + step.x, width), y = wrap(y0 + step.y, terrain.height);
        double slope = static_cast<double>(height) - terrain(x, y);
        if (slope <= steepest) continue;  // chance makes it only gentler
        if (step.length > 1)
          slope /= 2 - uniform_at(seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(&step - steps_around.data()));
        if (slope <= steepest || drainage.rank[static_cast<std::size_t>(y * width + x)] > drainage.rank[here]) continue;
        steepest = slope;
        drainage.receiver[here] = y * width + x;
        drainage.distance[here] = static_cast<float>(step.length);
      }
    }
  });
}

}  // namespace

void erode_by_streams(RasterView<float> terrain, RasterView<const float> uplift, RasterView<const unsigned char> outlet,
                      const StreamErosionOptions& options) {
  assert(terrain.size() == uplift.size() && terrain.size() == outlet.size() && terrain.size().cells() < not_flooded);
  const std::int64_t width = terrain.width;
  const double cell_area = options.cell_size_m * options.cell_size_m;
  std::vector<double> area(static_cast<std::size_t>(terrain.size().cells()));
  for (int step = 0; step < options.steps; ++step) {
    Drainage drainage = flood(terrain, outlet);
    steepen(terrain, hash_position(options.seed, static_cast<std::uint64_t>(step)), options.threads, drainage);

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
