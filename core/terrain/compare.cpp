#include "core/terrain/compare.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/slope.h"

namespace arete {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double steep_enough_deg = 2;  // below it the aspect is noise

struct Heights {
  double sum = 0, low = infinity, high = -infinity;
  void add(double z) {
    sum += z;
    extend(z);
  }
  void extend(double z) {
    low = std::min(low, z);
    high = std::max(high, z);
  }
  void add(const Heights& other) {
    sum += other.sum;
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

/// What one tile contributes.
struct Tally {
  std::int64_t cells = 0, only_reference = 0, only_result = 0, slope_cells = 0, aspect_cells = 0, blocks = 0;
  double error = 0, absolute = 0, square = 0, slope_square = 0, aspect_square = 0, block_square = 0;
  double worst = -1;
  std::int64_t worst_x = -1, worst_y = -1;
  Heights reference, result, original;  // `original`: every valid cell of the reference
  std::vector<float> magnitudes;        // |error| of each cell, until it is in the histogram

  void add(const Tally& t) {
    cells += t.cells, only_reference += t.only_reference, only_result += t.only_result;
    slope_cells += t.slope_cells, aspect_cells += t.aspect_cells, blocks += t.blocks;
    error += t.error, absolute += t.absolute, square += t.square;
    slope_square += t.slope_square, aspect_square += t.aspect_square, block_square += t.block_square;
    if (t.worst > worst) worst = t.worst, worst_x = t.worst_x, worst_y = t.worst_y;
    reference.add(t.reference), result.add(t.result), original.add(t.original);
  }
};

/// Counts of non-negative floats by their exponent and first 11 bits of mantissa: bins 0.05 % wide, in the order of the numbers.
class MagnitudeHistogram {
 public:
  void add(float magnitude) { ++counts_[std::bit_cast<std::uint32_t>(magnitude) >> dropped_bits]; }
  double percentile(double share, std::int64_t total) const {
    const auto needed = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(total)));
    std::int64_t seen = 0;
    for (std::size_t bin = 0; bin < counts_.size(); ++bin)
      if ((seen += counts_[bin]) >= needed && seen > 0)
        return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bin) << dropped_bits));
    return std::nan("");
  }

 private:
  static constexpr int dropped_bits = 12;
  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(std::size_t{1} << (31 - dropped_bits));
};

/// Both rasters on one tile; a cell that either lacks is void in both. The core of the tile is the part without the halo.
struct TilePair {
  Raster<float> reference, result;
  Window outer, core;  // in cells of the raster
};

class TileReader {
 public:
  TileReader(const RasterSource& reference, const RasterSource& result, const CompareOptions& options)
      : reference_(reference), result_(result), border_(options.border) {
    const Size size = reference.size();
    inside_ = {border_, border_, std::max<std::int64_t>(0, size.width - 2 * border_),
               std::max<std::int64_t>(0, size.height - 2 * border_)};
    // Whole blocks of the consistency in each tile.
    const std::int64_t factor = std::max(1, options.factor);
    side_ = factor * std::max<std::int64_t>(1, 512 / factor);
    columns_ = (size.width + side_ - 1) / side_;
    rows_ = (size.height + side_ - 1) / side_;
  }

  std::int64_t tiles() const { return columns_ * rows_; }

  /// `halo` cells more on each side where the raster goes on.
  TilePair read(std::int64_t tile, std::int64_t halo) const {
    const Size size = reference_.size();
    TilePair pair;
    const std::int64_t x = tile % columns_ * side_, y = tile / columns_ * side_;
    pair.core = {x, y, std::min(side_, size.width - x), std::min(side_, size.height - y)};
    const std::int64_t x0 = std::max<std::int64_t>(0, x - halo), y0 = std::max<std::int64_t>(0, y - halo);
    pair.outer = {x0, y0, std::min(size.width, x + pair.core.width + halo) - x0,
                  std::min(size.height, y + pair.core.height + halo) - y0};
    pair.reference = Raster<float>(pair.outer.width, pair.outer.height);
    pair.result = Raster<float>(pair.outer.width, pair.outer.height);
    reference_.read(pair.outer, pair.reference.view());
    result_.read(pair.outer, pair.result.view());
    return pair;
  }

  bool inside(std::int64_t x, std::int64_t y) const {
    return x >= inside_.x && y >= inside_.y && x < inside_.x + inside_.width && y < inside_.y + inside_.height;
  }

 private:
  const RasterSource &reference_, &result_;
  std::int64_t border_, side_, columns_, rows_;
  Window inside_;
};

/// Makes the two rasters void together, and counts the cells that only one of them has.
void mask_together(const TileReader& reader, TilePair& pair, Tally& tally) {
  for (std::int64_t y = 0; y < pair.outer.height; ++y)
    for (std::int64_t x = 0; x < pair.outer.width; ++x) {
      float &a = pair.reference(x, y), &b = pair.result(x, y);
      const std::int64_t cx = pair.outer.x + x, cy = pair.outer.y + y;
      const bool core = cx >= pair.core.x && cy >= pair.core.y && cx < pair.core.x + pair.core.width &&
                        cy < pair.core.y + pair.core.height;
      if (!reader.inside(cx, cy)) {
        a = b = void_value;
        continue;
      }
      if (core && !is_void(a)) tally.original.extend(static_cast<double>(a));
      if (core && is_void(a) != is_void(b)) ++(is_void(b) ? tally.only_reference : tally.only_result);
      if (is_void(a) || is_void(b)) a = b = void_value;
    }
}

void tally_heights(const TilePair& pair, Tally& tally) {
  const std::int64_t dx = pair.core.x - pair.outer.x, dy = pair.core.y - pair.outer.y;
  tally.magnitudes.reserve(static_cast<std::size_t>(pair.core.size().cells()));
  for (std::int64_t y = 0; y < pair.core.height; ++y)
    for (std::int64_t x = 0; x < pair.core.width; ++x) {
      const double a = static_cast<double>(pair.reference(x + dx, y + dy)), b = static_cast<double>(pair.result(x + dx, y + dy));
      if (std::isnan(a)) continue;
      const double error = b - a;
      ++tally.cells;
      tally.error += error;
      tally.absolute += std::abs(error);
      tally.square += error * error;
      if (std::abs(error) > tally.worst) {
        tally.worst = std::abs(error);
        tally.worst_x = pair.core.x + x;
        tally.worst_y = pair.core.y + y;
      }
      tally.reference.add(a);
      tally.result.add(b);
      tally.magnitudes.push_back(static_cast<float>(std::abs(error)));
    }
}

void tally_slopes(const TilePair& pair, CellSize cell, Tally& tally) {
  const std::int64_t dx = pair.core.x - pair.outer.x, dy = pair.core.y - pair.outer.y;
  const RasterView<const float> reference = pair.reference.view(), result = pair.result.view();
  for (std::int64_t y = 0; y < pair.core.height; ++y)
    for (std::int64_t x = 0; x < pair.core.width; ++x) {
      const auto a = complete_gradient(reference, x + dx, y + dy, cell), b = complete_gradient(result, x + dx, y + dy, cell);
      if (!a || !b) continue;
      const double slope_a = slope_deg(*a), slope_b = slope_deg(*b);
      ++tally.slope_cells;
      tally.slope_square += (slope_b - slope_a) * (slope_b - slope_a);
      if (slope_a < steep_enough_deg || slope_b < steep_enough_deg) continue;
      const double turn = std::remainder(aspect_deg(*b) - aspect_deg(*a), 360.0);
      ++tally.aspect_cells;
      tally.aspect_square += turn * turn;
    }
}

void tally_consistency(const TilePair& pair, int factor, Tally& tally) {
  const std::int64_t dx = pair.core.x - pair.outer.x, dy = pair.core.y - pair.outer.y;
  const double area = static_cast<double>(factor) * factor;
  for (std::int64_t by = 0; by + factor <= pair.core.height; by += factor)
    for (std::int64_t bx = 0; bx + factor <= pair.core.width; bx += factor) {
      double difference = 0;
      for (std::int64_t y = by; y < by + factor; ++y)
        for (std::int64_t x = bx; x < bx + factor; ++x)
          difference += static_cast<double>(pair.result(x + dx, y + dy)) - static_cast<double>(pair.reference(x + dx, y + dy));
      if (std::isnan(difference)) continue;
      ++tally.blocks;
      tally.block_square += difference / area * (difference / area);
    }
}

/// Calls work(tile) on every tile, some at a time on the threads, and then take(tile's value) in the order of the tiles.
template <typename Value, typename Work, typename Take>
void for_tiles_in_order(std::int64_t tiles, int threads, Progress& progress, const Work& work, const Take& take) {
  const std::int64_t together = 4 * static_cast<std::int64_t>(resolve_threads(threads));
  for (std::int64_t first = 0; first < tiles; first += together) {
    const std::int64_t count = std::min(together, tiles - first);
    std::vector<Value> values(static_cast<std::size_t>(count));
    parallel_for(count, threads, [&](std::int64_t i) { values[static_cast<std::size_t>(i)] = work(first + i); });
    for (const Value& value : values) take(value);
    progress.advance(count);
  }
}

/// Heights of both rasters in equal bins of their common range.
struct HeightHistogram {
  static constexpr std::size_t bins = 65536;
  double low = 0, high = 0;
  std::vector<std::int64_t> difference = std::vector<std::int64_t>(bins);  // result minus reference

  std::size_t bin(double z) const {
    return std::min(bins - 1, static_cast<std::size_t>((z - low) / (high - low) * static_cast<double>(bins)));
  }
  /// Integral of the absolute difference of the two cumulative distributions, which is the 1-Wasserstein distance on a line.
  double wasserstein(std::int64_t cells) const {
    double sum = 0;
    std::int64_t cumulative = 0;
    for (const std::int64_t count : difference) sum += std::abs(static_cast<double>(cumulative += count));
    return sum / static_cast<double>(cells) * (high - low) / static_cast<double>(bins);
  }
};

double wasserstein_distance(const TileReader& reader, const Tally& total, int threads, Progress& progress) {
  HeightHistogram histogram;
  histogram.low = std::min(total.reference.low, total.result.low);
  histogram.high = std::max(total.reference.high, total.result.high);
  if (!(histogram.high > histogram.low)) {
    progress.advance(reader.tiles());
    return total.cells == 0 ? std::nan("") : 0;
  }
  for_tiles_in_order<std::vector<std::uint32_t>>(
      reader.tiles(), threads, progress,
      [&](std::int64_t tile) {
        // Pairs of bins, reference then result.
        std::vector<std::uint32_t> moves;
        TilePair pair = reader.read(tile, 0);
        Tally ignored;
        mask_together(reader, pair, ignored);
        for (std::int64_t i = 0; i < pair.core.size().cells(); ++i) {
          if (is_void(pair.reference.data()[i])) continue;
          moves.push_back(static_cast<std::uint32_t>(histogram.bin(static_cast<double>(pair.reference.data()[i]))));
          moves.push_back(static_cast<std::uint32_t>(histogram.bin(static_cast<double>(pair.result.data()[i]))));
        }
        return moves;
      },
      [&](const std::vector<std::uint32_t>& moves) {
        for (std::size_t i = 0; i + 1 < moves.size(); i += 2) {
          --histogram.difference[moves[i]];
          ++histogram.difference[moves[i + 1]];
        }
      });
  return histogram.wasserstein(total.cells);
}

double mean_of(double sum, std::int64_t count) { return count == 0 ? std::nan("") : sum / static_cast<double>(count); }

double hypsometric_integral(const Heights& heights, std::int64_t cells) {
  const double range = heights.high - heights.low;
  return cells == 0 || !(range > 0) ? std::nan("") : (mean_of(heights.sum, cells) - heights.low) / range;
}

Comparison summarise(const Tally& t, const MagnitudeHistogram& magnitudes, bool with_consistency) {
  Comparison c;
  c.cells = t.cells, c.only_reference = t.only_reference, c.only_result = t.only_result;
  c.bias_m = mean_of(t.error, t.cells);
  c.rmse_m = std::sqrt(mean_of(t.square, t.cells));
  c.mae_m = mean_of(t.absolute, t.cells);
  c.max_m = t.cells == 0 ? std::nan("") : t.worst;
  c.max_x = t.worst_x, c.max_y = t.worst_y;
  c.p50_m = magnitudes.percentile(0.50, t.cells), c.p90_m = magnitudes.percentile(0.90, t.cells);
  c.p95_m = magnitudes.percentile(0.95, t.cells), c.p99_m = magnitudes.percentile(0.99, t.cells);
  c.peak_m = t.original.high >= t.original.low ? t.original.high - t.original.low : std::nan("");
  c.psnr_db = c.rmse_m == 0 ? infinity : 20 * std::log10(c.peak_m / c.rmse_m);
  c.slope_cells = t.slope_cells, c.aspect_cells = t.aspect_cells;
  c.slope_rmse_deg = std::sqrt(mean_of(t.slope_square, t.slope_cells));
  c.aspect_rmse_deg = std::sqrt(mean_of(t.aspect_square, t.aspect_cells));
  if (with_consistency) c.consistency_m = std::sqrt(mean_of(t.block_square, t.blocks));
  c.consistency_blocks = t.blocks;
  c.integral_reference = hypsometric_integral(t.reference, t.cells);
  c.integral_result = hypsometric_integral(t.result, t.cells);
  return c;
}

}  // namespace

Comparison compare_terrain(const RasterSource& reference, const RasterSource& result, const CompareOptions& options,
                           Progress& progress) {
  const Size a = reference.size(), b = result.size();
  if (a != b)
    throw Error(ErrorKind::input, "cannot compare a reference of " + std::to_string(a.width) + " x " + std::to_string(a.height) +
                                      " cells with a result of " + std::to_string(b.width) + " x " + std::to_string(b.height));
  const TileReader reader(reference, result, options);
  progress.begin("comparing", 2 * reader.tiles());
  Tally total;
  MagnitudeHistogram magnitudes;
  for_tiles_in_order<Tally>(
      reader.tiles(), options.threads, progress,
      [&](std::int64_t tile) {
        Tally tally;
        TilePair pair = reader.read(tile, 1);
        mask_together(reader, pair, tally);
        tally_heights(pair, tally);
        tally_slopes(pair, options.cell, tally);
        if (options.factor > 1) tally_consistency(pair, options.factor, tally);
        return tally;
      },
      [&](const Tally& tally) {
        total.add(tally);
        for (const float magnitude : tally.magnitudes) magnitudes.add(magnitude);
      });
  Comparison comparison = summarise(total, magnitudes, options.factor > 1);
  comparison.wasserstein_m = wasserstein_distance(reader, total, options.threads, progress);
  progress.end();
  return comparison;
}

Comparison compare_terrain(RasterView<const float> reference, RasterView<const float> result, const CompareOptions& options) {
  NoProgress silent;
  return compare_terrain(ViewSource(reference), ViewSource(result), options, silent);
}

}  // namespace arete
