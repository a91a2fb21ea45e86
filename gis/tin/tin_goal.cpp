#include "gis/tin/tin_goal.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "core/support/error.h"

namespace arete {
namespace {

constexpr int most_tries = 20;
constexpr double least_bound_m = 1e-4, greatest_bound_m = 1e5;

/// A quantity of TINs that falls, or rises, with their bound, and what it is to be.
struct Goal {
  std::function<double(const TinReport&)> measure;
  bool falls;        ///< with a larger bound
  double most;       ///< it must not be above this
  double least;      ///< and is best not below this
};

/// Bounds between which the goal lies, with the logarithm of the measure over the goal there.
struct End {
  double bound, off;
};

/// A bound where a line through the ends, in logarithms, meets the goal; kept inside so that the ends close in from both sides.
double between(const End& low, const End& high) {
  const double share = std::clamp(low.off / (low.off - high.off), 0.05, 0.95);
  return std::exp(std::log(low.bound) + share * (std::log(high.bound) - std::log(low.bound)));
}

Tin search(const RasterSource& raster, const Goal& goal, TinOptions options, Progress& progress) {
  const double aim = std::sqrt(goal.most * goal.least);
  std::optional<End> low, high;  // bounds too small and too large for the goal
  std::optional<Tin> best;
  double bound = options.max_error_m, best_bound = 0, least_factor = 1.1, fewest = 0;
  for (int tried = 0; tried < most_tries; ++tried) {
    options.max_error_m = bound;
    Tin tin = make_tin(raster, options, progress);
    const double measure = goal.measure(tin.report);
    const bool allowed = measure <= goal.most, near = measure >= goal.least;
    if (allowed && (!best || measure > goal.measure(best->report))) best = std::move(tin), best_bound = bound;
    if (allowed && near) return std::move(*best);
    const double off = std::log(std::max(measure, 1e-9) / aim);
    if (tried == 0 || measure < fewest) fewest = measure;
    const bool too_small = goal.falls ? measure > goal.most : allowed;
    (too_small ? low : high) = End{bound, off};
    if (low && high) {
      if (high->bound / low->bound < 1 + 1e-9) break;
      bound = between(*low, *high);
    } else {
      // Larger steps each time: outlines of voids may leave the measure as it is through many of them.
      const double factor = std::clamp(std::exp(std::abs(off)), least_factor, 8.0), last = bound;
      least_factor = std::min(8.0, least_factor * least_factor);
      bound = std::clamp(too_small ? bound * factor : bound / factor, least_bound_m, greatest_bound_m);
      if (bound == last) break;
    }
  }
  if (!best && goal.falls)
    throw Error(ErrorKind::usage, "the raster needs " + std::to_string(static_cast<std::int64_t>(fewest)) + " triangles at least, for its border and its voids; " +
                                      std::to_string(static_cast<std::int64_t>(goal.most)) + " are asked for");
  if (!best) throw Error(ErrorKind::usage, "no bound between 0.0001 and 100000 m reaches this goal");
  if (!goal.falls || best->report.max_error_m == 0) return std::move(*best);
  // Whole metres leave jumps: a bound just below one metre needs more triangles than one of a metre by far. What is left is spent where
  // errors are largest.
  options.max_error_m = best_bound;
  options.extra_share = goal.most / goal.measure(best->report) - 1;
  best.reset();
  return make_tin(raster, options, progress);
}

double first_bound(const RasterSource& raster, const TinOptions& options) {
  if (options.max_error_m > 0) return options.max_error_m;
  const Size size = raster.size();
  const Window middle{size.width / 2 - std::min<std::int64_t>(size.width, 512) / 2, size.height / 2 - std::min<std::int64_t>(size.height, 512) / 2,
                      std::min<std::int64_t>(size.width, 512), std::min<std::int64_t>(size.height, 512)};
  Raster<float> cells(middle.width, middle.height);
  raster.read(middle, cells.view());
  float low = 0, high = 0;
  bool any = false;
  for (std::int64_t i = 0; i < middle.size().cells(); ++i) {
    const float h = cells.data()[i];
    if (is_void(h)) continue;
    low = any ? std::min(low, h) : h, high = any ? std::max(high, h) : h;
    any = true;
  }
  return std::max(0.01, (static_cast<double>(high) - low) / 100);
}

}  // namespace

Tin make_tin_of_triangles(const RasterSource& raster, std::int64_t triangles, TinOptions options, Progress& progress) {
  options.max_error_m = first_bound(raster, options);
  const Goal goal{[](const TinReport& report) { return static_cast<double>(report.triangles); }, true, static_cast<double>(triangles),
                  0.99 * static_cast<double>(triangles)};
  Tin tin = search(raster, goal, options, progress);
  return tin;
}

Tin make_tin_of_rmse(const RasterSource& raster, double rmse_m, TinOptions options, Progress& progress) {
  options.max_error_m = options.max_error_m > 0 ? options.max_error_m : 3 * rmse_m;
  return search(raster, {[](const TinReport& report) { return report.rmse_m; }, false, rmse_m, 0.98 * rmse_m}, options, progress);
}

}  // namespace arete
