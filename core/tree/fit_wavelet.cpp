#include "core/tree/fit_wavelet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/codec/wavelet_coder.h"

namespace arete {
namespace {

constexpr float lambda = 0.2F;               // bits against squared error in steps: within 0.01 dB of the best from 0.12 to 0.3
constexpr int fine_side = 256;
constexpr int wide_side = 512;
constexpr double sparse_bits_per_cell = 0.25;
constexpr int most_trials = 12;
constexpr double close_enough = 0.997;       // of an error that is aimed at: 0.03 dB
constexpr double filled_enough = 0.99;       // of a size that is aimed at

class Search {
 public:
  Search(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress)
      : cells_(cells), header_(header), options_(options), progress_(progress), filled_(fill_cells(cells)) {}

  void prepare(int side) {
    header_.coder = TreeCoder::wavelet;
    header_.grid = NodeGrid(cells_.stored.size(), side);
    pyramid_ = analyse_raster(filled_.view(), header_.grid, options_.threads);
    masks_ = encode_masks(cells_, header_.grid, options_.threads);
  }

  std::vector<std::byte> encode(double step) {
    if (progress_) progress_->advance(1);
    const WaveletStreams streams = encode_wavelet(pyramid_, static_cast<float>(step), lambda, options_.passes, options_.threads);
    header_.parameters = encode_wavelet_parameters(streams.parameters);
    return write_tree(header_, masks_, streams.root, streams.nodes);
  }

 private:
  const TreeCells& cells_;
  TreeHeader header_;
  const CompressOptions& options_;
  Progress* progress_;
  Raster<float> filled_;
  WaveletPyramid pyramid_;
  MaskStreams masks_;
};

// The point at which a monotone curve through two points (in logarithms) reaches a value.
double follow(double x0, double y0, double x1, double y1, double y) {
  const double slope = (std::log(y1) - std::log(y0)) / (std::log(x1) - std::log(x0));
  const double steps = std::isfinite(slope) && std::abs(slope) > 0.05 ? (std::log(y) - std::log(y1)) / slope : 0;
  return x1 * std::exp(std::clamp(steps, -3.0, 3.0));
}

// The widest step whose error, measured on the file, does not exceed `target_m`; the error grows with the step.
FittedTree search_error(Search& search, const TreeCells& cells, const CompressOptions& options, double target_m) {
  const double target = target_m / cells.metres_per_stored;
  double step = 1.6 * target, step_before = 0, error_before = 0;
  double widest_good = 0, narrowest_bad = std::numeric_limits<double>::infinity();
  FittedTree best;
  for (int trial = 0; trial < most_trials; ++trial) {
    FittedTree found{search.encode(step), {}, TreeCoder::wavelet, {}};
    found.errors = measure_file(cells, found.file, options.threads);
    const double error = found.errors.rmse_m / cells.metres_per_stored;
    if (error <= target) {
      widest_good = std::max(widest_good, step);
      best = std::move(found);
      if (error >= close_enough * target || error == 0) return best;
    } else {
      narrowest_bad = std::min(narrowest_bad, step);
    }
    double next = trial == 0 || error == 0 ? step * 0.9985 * target / std::max(error, 1e-300) : follow(step_before, error_before, step, error, 0.9985 * target);
    step_before = step;
    error_before = error;
    // Beside the bracket: halve it.
    if (!(next > widest_good && next < narrowest_bad)) next = std::isfinite(narrowest_bad) ? std::sqrt(std::max(widest_good, narrowest_bad / 64) * narrowest_bad) : step * 4;
    if (widest_good > 0 && narrowest_bad / widest_good < 1.002) break;
    step = next;
  }
  return best;
}

// The narrowest step whose file is not larger than `target`.
FittedTree search_bytes(Search& search, const TreeCells& cells, const CompressOptions& options, double target) {
  double step = std::max(1e-6, (cells.highest - cells.lowest) * 0.004), step_before = 0, bytes_before = 0;
  double narrowest_good = std::numeric_limits<double>::infinity(), widest_bad = 0;
  std::vector<std::byte> best;
  for (int trial = 0; trial < most_trials; ++trial) {
    std::vector<std::byte> file = search.encode(step);
    const auto bytes = static_cast<double>(file.size());
    if (bytes <= target) {
      if (step < narrowest_good) {
        narrowest_good = step;
        best = std::move(file);
      }
      if (bytes >= filled_enough * target) break;
    } else {
      widest_bad = std::max(widest_bad, step);
    }
    double next = trial == 0 ? step * std::pow(bytes / target, 1.3) : follow(step_before, bytes_before, step, bytes, 0.996 * target);
    step_before = step;
    bytes_before = bytes;
    if (!(next > widest_bad && next < narrowest_good)) next = std::isfinite(narrowest_good) ? std::sqrt(narrowest_good * std::max(widest_bad, narrowest_good / 64)) : step * 4;
    if (widest_bad > 0 && narrowest_good / widest_bad < 1.001) break;
    step = next;
  }
  FittedTree found{std::move(best), {}, TreeCoder::wavelet, {}};
  if (!found.file.empty()) found.errors = measure_file(cells, found.file, options.threads);
  return found;
}

FittedTree search_target(Search& search, const TreeCells& cells, const CompressOptions& options, double rmse_m) {
  if (options.target.kind == TreeClaim::bytes) return search_bytes(search, cells, options, options.target.value);
  return search_error(search, cells, options, rmse_m);
}

}  // namespace

FittedTree fit_wavelet(const TreeCells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress) {
  const double range_m = std::max((cells.highest - cells.lowest) * cells.metres_per_stored, 1e-9);
  const double rmse_m = options.target.kind == TreeClaim::psnr ? range_m / std::pow(10, options.target.value / 20) : options.target.value;
  Search search(cells, header, options, progress);
  search.prepare(options.node_side > 0 ? options.node_side : fine_side);
  FittedTree found = search_target(search, cells, options, rmse_m);
  if (options.node_side > 0 || found.file.empty() || found.errors.bits_per_sample() >= sparse_bits_per_cell) return found;
  search.prepare(wide_side);
  FittedTree wide = search_target(search, cells, options, rmse_m);
  const bool better = options.target.kind == TreeClaim::bytes ? wide.errors.rmse_m < found.errors.rmse_m : wide.file.size() < found.file.size();
  return !wide.file.empty() && better ? std::move(wide) : std::move(found);
}

}  // namespace arete
