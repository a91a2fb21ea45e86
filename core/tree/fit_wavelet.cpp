#include "core/tree/fit_wavelet.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "core/codec/stream_parts.h"
#include "core/codec/wavelet_encoder.h"

namespace arete {
namespace {

constexpr int fine_side = 256;
constexpr int wide_side = 512;
constexpr double sparse_bits_per_cell = 0.25;
constexpr std::int64_t most_cells_of_wide = std::int64_t{1} << 24;  // windows of larger rasters come faster from small nodes
constexpr double least_step = 1e-30, greatest_step = 1e30;  // floats that the norms of all levels leave finite and above 0
constexpr int most_trials = 14;
constexpr int patience = 8;             // trials, where the tree is so small that its error jumps
constexpr double close_enough = 0.997;  // of an error that is aimed at: 0.03 dB
constexpr double short_of = 0.9985;     // what is tried for: between that and the error itself
constexpr double filled_enough = 0.99;  // of a size that is aimed at
constexpr double size_aim = 0.9955;     // between that and the size itself
constexpr double usual_ratio = 1.04;    // of the error in the file to that of the bands, which are not quite orthogonal
constexpr double least_water = 0.01;    // of the cells, to be looked at
constexpr double near_enough = 0.03;    // a first estimate that is further off needs no measuring,
constexpr double plausible = 0.15;      // nor do later ones beyond this, which are wrong by less

// A step that was tried.
struct Trial {
  double step = 0;
  std::shared_ptr<const ByteSource> file;
  double estimated = 0;  // RMSE in stored units, from the bands
  TreeErrors found;      // where it was measured
};

// The RMSE of whole numbers that are decoded with normal errors and then rounded.
double rounded_error(double rmse) {
  if (rmse > 5) return std::sqrt(rmse * rmse + 1.0 / 12);
  if (!(rmse > 0)) return 0;
  const auto beyond = [&](double error) { return std::erfc(error / (rmse * std::sqrt(2.0))); };
  double sum = 0;
  for (int k = 1; k < 40; ++k) sum += k * k * (beyond(k - 0.5) - beyond(k + 0.5));
  return std::sqrt(sum);
}

class Search {
 public:
  Search(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress)
      : cells_(cells), header_(header), options_(options), progress_(progress ? *progress : silent_), filled_(cells, options.scratch, options.threads) {}

  void prepare(int side) {
    header_.coder = TreeCoder::wavelet;
    header_.grid = NodeGrid(cells_.size(), side);
    if (!pyramid_) analyse();
    pyramid_->grid = header_.grid;  // levels do not depend on the side of nodes
    masks_ = encode_masks(cells_, header_.grid, options_.scratch, options_.threads);
    flat_ = {};
    if (options_.flat == FlatWater::exact) find_flat_water(0);
  }

  // From now on trees hold flat water exactly, if that is at least this share of the cells. Gives whether it is.
  bool find_flat_water(double least_share) {
    flat_ = encode_flat_water(cells_, header_.type, header_.grid, least_share, options_.scratch, options_.threads);
    return flat_.any();
  }
  void forget_flat_water() { flat_ = {}; }

  Trial encode(double step) {
    // Below the last bit of the floats there is nothing to gain.
    const double resolution = std::ldexp(std::max(std::abs(cells_.range.lowest), std::abs(cells_.range.highest)), -26);
    const double finest = std::max({least_step, pyramid_->details.least_step(), resolution});
    step = std::min(greatest_step, step > finest ? step : finest);
    progress_.begin(trials_++ == 0 ? "encoding" : "encoding, try " + std::to_string(trials_), header_.grid.node_count());
    TreeDraft draft(masks_, flat_, options_.scratch);
    WaveletEncoding how;
    how.step = static_cast<float>(step);
    how.passes = options_.passes;
    how.threads = options_.threads;
    how.progress = [this](std::int64_t nodes) { progress_.advance(nodes); };
    WaveletSummary summary = encode_wavelet(*pyramid_, how, draft.nodes());
    progress_.end();
    return {step, finish(draft, summary.parameters, summary.root), error_of(summary.squared_error, step), {}};
  }

  // The same tree, with the flat water that was found meanwhile.
  Trial add_flat_water(const Trial& trial) {
    const TreeFile file(trial.file, "the tree without flat water");
    const auto coded = [&](std::vector<std::byte> stream) { return file.header().voids ? split_parts(stream, file.name()).rest : stream; };
    TreeDraft draft(masks_, flat_, options_.scratch);
    const NodeStore nodes = draft.nodes();
    for (std::size_t i = 0; i < file.nodes().size(); ++i) nodes.add(coded(file.read_node(static_cast<std::int64_t>(i))));
    const WaveletParameters parameters = decode_wavelet_parameters(file.header().parameters, header_.grid, file.name());
    return {trial.step, finish(draft, parameters, coded(file.header().root)), trial.estimated, {}};
  }

  // RMSE in stored units.
  double measure(Trial& trial) {
    trial.found = measure_file(cells_, trial.file, options_.scratch, options_.threads, &progress_);
    return trial.found.rmse_m / cells_.metres_per_stored;
  }

  // What the details let expect of a step: RMSE in stored units.
  double expected_error(double step) const { return usual_ratio * error_of(pyramid_->details.squared_error(step), step); }
  double expected_bytes(double step) const { return pyramid_->details.bits(step) / 8; }
  // Of masks and index.
  double fixed_bytes() const { return static_cast<double>(masks_.bytes() + flat_.bytes() + 6 * static_cast<std::size_t>(header_.grid.node_count())); }

 private:
  void analyse() {
    std::int64_t cells = 0;
    for (int level = 1; level <= header_.grid.levels(); ++level) cells += header_.grid.level_size(level).cells();
    progress_.begin("analysing", cells);
    pyramid_ = analyse_raster(filled_, header_.grid, options_.scratch, options_.threads, [this](std::int64_t more) { progress_.advance(more); });
    progress_.end();
  }

  std::shared_ptr<const ByteSource> finish(TreeDraft& draft, WaveletParameters parameters, const std::vector<std::byte>& root) {
    parameters.flat = flat_.any();
    header_.parameters = encode_wavelet_parameters(parameters);
    return draft.finish(header_, root);
  }

  // Of the details' squared error and of the root's: its steps, of a low-pass value, are 2 step / norm, and each value counts norm^2.
  double error_of(double squared_error, double step) const {
    const double root = static_cast<double>(header_.grid.level_size(header_.grid.levels()).cells()) * step * step / 3;
    const double rmse = std::sqrt((std::max(0.0, squared_error) + root) / static_cast<double>(cells_.size().cells()));
    return is_integer(header_.type) ? rounded_error(rmse) : rmse;
  }

  NoProgress silent_;
  const TreeCells& cells_;
  TreeHeader header_;
  const CompressOptions& options_;
  Progress& progress_;
  int trials_ = 0;
  FilledCells filled_;
  std::optional<WaveletPyramid> pyramid_;
  MaskStreams masks_, flat_;
};

// The step at which a model, that grows with it (or falls), comes to a value.
double solve(const std::function<double(double)>& model, bool grows, double value) {
  double low = 1e-9, high = 1e9;
  for (int i = 0; i < 80; ++i) {
    const double middle = std::sqrt(low * high);
    ((model(middle) < value) == grows ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

// How a model changes with the step, in logarithms.
double slope_of(const std::function<double(double)>& model, double step) { return std::log(model(step * 1.2) / model(step / 1.2)) / std::log(1.44); }

// How what is searched for changes with the step, in logarithms: as it did from the trial before, or as a model says; held to what is
// plausible.
class Slope {
 public:
  Slope(std::function<double(double)> model, double least, double most) : model_(std::move(model)), least_(least), most_(most) {}
  double at(double step, double value) {
    const bool known = step_ > 0 && std::abs(std::log(step / step_)) > 0.003 && value > 0 && value_ > 0;
    const double slope = known ? std::log(value / value_) / std::log(step / step_) : slope_of(model_, step);
    step_ = step;
    value_ = value;
    return std::isfinite(slope) ? std::clamp(slope, least_, most_) : (least_ + most_) / 2;
  }

 private:
  std::function<double(double)> model_;
  double least_, most_;
  double step_ = 0, value_ = 0;
};

// The steps last found to be good and to be bad, and the next one to try between them.
struct Bracket {
  double good = 0, bad = 0;  // 0: none yet
  double next(double wanted) const {
    if (good > 0 && bad > 0) {
      const auto [low, high] = std::minmax(good, bad);
      return wanted > low && wanted < high ? wanted : std::sqrt(low * high);
    }
    return wanted;
  }
  bool closed(double nearly) const { return good > 0 && bad > 0 && std::max(good, bad) / std::min(good, bad) < nearly; }
};

// The widest step whose error, measured on the file, does not exceed `target` (stored units).
Trial search_error(Search& search, double target, Trial trial) {
  Bracket steps;
  Trial best;
  Slope slope([&](double step) { return search.expected_error(step); }, 0.2, 1.5);
  double ratio = usual_ratio;  // of measured to estimated errors
  for (int i = 0; i < most_trials; ++i) {
    const double step = trial.step, estimated = trial.estimated;
    double error = estimated * ratio;
    const double off = std::abs(error / target - short_of);
    const bool measured = off < (i == 0 ? near_enough : plausible) || error == 0;
    if (measured) {
      error = search.measure(trial);
      if (estimated > 0) ratio = error / estimated;
    }
    if (measured || off > plausible) (error <= target ? steps.good : steps.bad) = step;
    if (measured && error <= target && (!best.file || step > best.step)) {
      best = std::move(trial);
      if (error >= close_enough * target || error == 0) break;
    }
    // Steps that are nearly the same, or a file so small that its error does not follow the step.
    if (best.file && (steps.closed(1.002) || i >= patience)) break;
    const double factor = error > 0 ? std::pow(short_of * target / error, 1 / slope.at(step, estimated)) : 2;
    trial = search.encode(steps.next(step * std::clamp(factor, 0.02, 50.0)));
    if (trial.step == step) break;  // none finer
  }
  return best;
}

// The narrowest step whose file is not larger than `target`.
Trial search_bytes(Search& search, double target, Trial trial) {
  Bracket steps;
  Trial best;
  Slope slope([&](double step) { return search.expected_bytes(step); }, -2, -0.2);
  const double fixed = search.fixed_bytes();
  if (fixed > target) return {};
  for (int i = 0; i < most_trials; ++i) {
    const double bytes = static_cast<double>(trial.file->size()), step = trial.step;
    if (bytes <= target) {
      steps.good = step;
      if (!best.file || step < best.step) best = std::move(trial);
      if (bytes >= filled_enough * target) break;
    } else {
      steps.bad = step;
    }
    if (steps.closed(1.001)) break;
    const double left = std::max(1.0, size_aim * target - fixed), used = std::max(1.0, bytes - fixed);
    const double factor = std::pow(left / used, 1 / slope.at(step, used));
    trial = search.encode(steps.next(step * std::clamp(factor, 0.02, 50.0)));
    if (trial.step == step) break;  // none finer
  }
  if (best.file) search.measure(best);
  return best;
}

// What is asked for: bytes, or an RMSE in stored units.
struct Aim {
  bool bytes = false;
  double value = 0;
};

Trial search_aim(Search& search, const Aim& aim, Trial first) {
  return aim.bytes ? search_bytes(search, aim.value, std::move(first)) : search_error(search, aim.value, std::move(first));
}

// The first try: of two sides of nodes at the same step, hence nearly the same error, the smaller file.
Trial start(Search& search, const Aim& aim, std::int64_t cells, int side) {
  search.prepare(side > 0 ? side : fine_side);
  const double step = aim.bytes ? solve([&](double s) { return search.expected_bytes(s); }, false, std::max(1.0, aim.value - search.fixed_bytes()))
                                : solve([&](double s) { return search.expected_error(s); }, true, aim.value);
  Trial first = search.encode(step);
  if (side > 0 || cells > most_cells_of_wide || 8.0 * static_cast<double>(first.file->size()) >= sparse_bits_per_cell * static_cast<double>(cells)) return first;
  search.prepare(wide_side);
  Trial wide = search.encode(step);
  if (wide.file->size() < first.file->size()) return wide;
  search.prepare(fine_side);
  return first;
}

// Makes flat water exact where that is worth its bytes: what it takes off the error would cost more otherwise.
Trial try_flat_water(Search& search, const Aim& aim, Trial best) {
  if (!search.find_flat_water(least_water)) return best;
  Trial exact = search.add_flat_water(best);
  search.measure(exact);
  const double bytes_slope = slope_of([&](double s) { return search.expected_bytes(s); }, best.step);
  const double error_slope = slope_of([&](double s) { return search.expected_error(s); }, best.step);
  const double bytes_for_error = std::clamp(-bytes_slope / error_slope, 0.2, 3.0);  // relative to relative
  const double gain = bytes_for_error * std::log(best.found.rmse_m / exact.found.rmse_m) -
                      std::log(static_cast<double>(exact.file->size()) / static_cast<double>(best.file->size()));
  if (gain > 0) {
    Trial found = search_aim(search, aim, std::move(exact));
    const bool better = found.file && (aim.bytes ? found.found.rmse_m < best.found.rmse_m : found.file->size() < best.file->size());
    if (better) return found;
  }
  search.forget_flat_water();
  return best;
}

}  // namespace

FittedTree fit_wavelet(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  const double range = cells.range.highest > cells.range.lowest ? cells.range.highest - cells.range.lowest : 1e-9;
  Aim aim{options.target.kind == TreeClaim::bytes, options.target.value};
  if (options.target.kind == TreeClaim::psnr) aim.value = range / std::pow(10, options.target.value / 20);
  if (options.target.kind == TreeClaim::rmse) aim.value /= cells.metres_per_stored;
  Search search(cells, header, options, progress);
  Trial best = search_aim(search, aim, start(search, aim, cells.size().cells(), options.node_side));
  if (best.file && options.flat == FlatWater::automatic) best = try_flat_water(search, aim, std::move(best));
  // Of a raster that is flat, or nearly so, the ratio claimed may not be what the error aimed at stands for.
  if (best.file && !keeps_claim(header, best.found)) return {};
  return {std::move(best.file), best.found, TreeCoder::wavelet, {}};
}

}  // namespace arete
