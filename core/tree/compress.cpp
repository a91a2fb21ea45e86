#include "core/tree/compress.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/codec/void_mask_coder.h"
#include "core/codec/wavelet_coder.h"
#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/fill_voids.h"
#include "core/tree/elevation_tree.h"

namespace arete {
namespace {

constexpr float lambda = 0.2F;               // bits against squared error in steps: within 0.01 dB of the best from 0.12 to 0.3
constexpr int fine_side = 256;
constexpr int wide_side = 512;
constexpr double sparse_bits_per_cell = 0.25;
constexpr int most_trials = 12;
constexpr double close_enough = 0.997;       // of an error that is aimed at: 0.03 dB
constexpr double filled_enough = 0.99;       // of a size that is aimed at

// The raster as the coder sees it.
struct Cells {
  Raster<double> stored;
  Raster<float> filled;
  VoidMask voids;
  bool any_void = false;
  std::int64_t valid = 0;
  double lowest = 0, highest = 0;  // stored
  double metres_per_stored = 1;
};

Cells read_cells(const StoredSource& source, const TreeHeader& header) {
  const Size size = source.size();
  Cells cells{Raster<double>(size.width, size.height), Raster<float>(size.width, size.height), {Raster<std::uint8_t>(size.width, size.height), 0, 0}};
  source.read_stored({0, 0, size.width, size.height}, cells.stored.view());
  cells.lowest = std::numeric_limits<double>::infinity();
  cells.highest = -cells.lowest;
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    const double value = cells.stored.data()[i];
    const bool is_void_cell = std::isnan(value);
    cells.voids.cells.data()[i] = is_void_cell;
    cells.filled.data()[i] = is_void_cell ? void_value : static_cast<float>(value);
    if (is_void_cell) continue;
    ++cells.valid;
    cells.lowest = std::min(cells.lowest, value);
    cells.highest = std::max(cells.highest, value);
  }
  cells.any_void = cells.valid < size.cells();
  if (cells.valid == 0) throw Error(ErrorKind::input, "nothing to compress: all " + std::to_string(size.cells()) + " cells are void");
  if (cells.any_void) fill_voids(cells.filled.view());
  cells.metres_per_stored = std::abs(header.scale) * header.geo.metres_per_unit;
  return cells;
}

// One try: the streams at a step, and the file that they make.
struct Trial {
  float step = 0;
  WaveletStreams streams;
  double bytes = 0;         // of the streams, and of the masks and the index
  double estimated_rmse = 0;  // stored, from the bands
};

class Search {
 public:
  Search(const Cells& cells, const TreeHeader& header, const CompressOptions& options, Progress* progress)
      : cells_(cells), header_(header), options_(options), progress_(progress) {
    prepare(options.node_side > 0 ? options.node_side : fine_side);
  }

  void prepare(int side) {
    grid_ = NodeGrid(cells_.stored.size(), side);
    pyramid_ = analyse_raster(cells_.filled.view(), grid_, options_.threads);
    encode_masks();
  }

  Trial encode(float step) const {
    if (progress_) progress_->advance(0);
    Trial trial{step, encode_wavelet(pyramid_, step, lambda, options_.passes, options_.threads)};
    trial.bytes = static_cast<double>(trial.streams.bytes()) + mask_bytes_;
    for (const std::vector<std::byte>& node : trial.streams.nodes) trial.bytes += node.empty() ? 1 : 6;
    trial.estimated_rmse = std::sqrt(std::max(0.0, trial.streams.squared_error) / static_cast<double>(cells_.stored.size().cells()));
    return trial;
  }

  // The file of a trial in memory.
  std::vector<std::byte> write(const Trial& trial) const {
    std::vector<std::byte> file;
    TreeWriter writer([&](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
    for (std::size_t i = 0; i < trial.streams.nodes.size(); ++i)
      writer.add_node(cells_.any_void ? join_parts({masks_[i], trial.streams.nodes[i]}) : trial.streams.nodes[i]);
    TreeHeader header = header_;
    header.coder = TreeCoder::wavelet;
    header.grid = grid_;
    header.voids = cells_.any_void;
    header.parameters = encode_wavelet_parameters(trial.streams.parameters);
    header.root = cells_.any_void ? join_parts({root_mask_, trial.streams.root}) : trial.streams.root;
    writer.finish(header);
    return file;
  }

  const NodeGrid& grid() const { return grid_; }

 private:
  void encode_masks() {
    masks_.clear();
    mask_bytes_ = 0;
    if (!cells_.any_void) return;
    masks_.resize(static_cast<std::size_t>(grid_.node_count()));
    VoidMask fine{cells_.voids.cells.clone(), 0, 0};
    for (int level = 1; level <= grid_.levels(); ++level) {
      VoidMask coarse = coarsen_voids(fine);
      const Size nodes = grid_.nodes(level);
      parallel_for(nodes.cells(), options_.threads, [&](std::int64_t i) {
        const NodeAddress node{level, i % nodes.width, i / nodes.width};
        masks_[static_cast<std::size_t>(grid_.index(node))] = encode_voids(grid_, node, coarse, fine);
      });
      fine = std::move(coarse);
    }
    root_mask_ = encode_root_voids(fine);
    for (const std::vector<std::byte>& mask : masks_) mask_bytes_ += static_cast<double>(mask.size()) + 1;
  }

  const Cells& cells_;
  TreeHeader header_;
  const CompressOptions& options_;
  Progress* progress_;
  NodeGrid grid_;
  WaveletPyramid pyramid_;
  std::vector<std::vector<std::byte>> masks_;
  std::vector<std::byte> root_mask_;
  double mask_bytes_ = 0;
};

// What a reader of the file will find, against the original.
CompressionReport measure(const Cells& cells, const std::vector<std::byte>& file, int threads) {
  const ElevationTree tree(TreeFile(view_bytes(file), "the tree just made"), threads);
  const Size size = cells.stored.size();
  CompressionReport report;
  report.bytes = file.size();
  report.cells = size.cells();
  report.valid_cells = cells.valid;
  constexpr std::int64_t strip = 1024;
  double squares = 0;
  for (std::int64_t y = 0; y < size.height; y += strip) {
    const Window at{0, y, size.width, std::min(strip, size.height - y)};
    Raster<double> decoded(at.width, at.height);
    tree.read_stored(0, at, decoded.view());
    for (std::int64_t row = 0; row < at.height; ++row)
      for (std::int64_t x = 0; x < at.width; ++x) {
        const double truth = cells.stored(x, y + row);
        if (std::isnan(truth)) continue;
        const double error = std::abs(decoded(x, row) - truth);
        squares += error * error;
        report.max_error_m = std::max(report.max_error_m, error * cells.metres_per_stored);
      }
  }
  report.rmse_m = std::sqrt(squares / static_cast<double>(cells.valid)) * cells.metres_per_stored;
  report.lowest_m = cells.lowest * cells.metres_per_stored;
  report.highest_m = cells.highest * cells.metres_per_stored;
  return report;
}

// The point at which a monotone curve through two points (in logarithms) reaches a value.
double follow(double x0, double y0, double x1, double y1, double y) {
  const double slope = (std::log(y1) - std::log(y0)) / (std::log(x1) - std::log(x0));
  const double steps = std::isfinite(slope) && std::abs(slope) > 0.05 ? (std::log(y) - std::log(y1)) / slope : 0;
  return x1 * std::exp(std::clamp(steps, -3.0, 3.0));
}

struct Found {
  std::vector<std::byte> file;
  CompressionReport report;
};

// The widest step whose error, measured on the file, does not exceed `target_m`; the error grows with the step.
Found search_error(Search& search, const Cells& cells, const CompressOptions& options, double target_m) {
  const double target = target_m / cells.metres_per_stored;
  double step = 1.6 * target, step_before = 0, error_before = 0;
  double widest_good = 0, narrowest_bad = std::numeric_limits<double>::infinity();
  Found best;
  for (int trial = 0; trial < most_trials; ++trial) {
    const Trial now = search.encode(static_cast<float>(step));
    Found found{search.write(now), {}};
    found.report = measure(cells, found.file, options.threads);
    const double error = found.report.rmse_m / cells.metres_per_stored;
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
Found search_bytes(Search& search, const Cells& cells, const CompressOptions& options, double target) {
  double step = std::max(1e-6, (cells.highest - cells.lowest) * 0.004), step_before = 0, bytes_before = 0;
  double narrowest_good = std::numeric_limits<double>::infinity(), widest_bad = 0;
  std::vector<std::byte> best;
  for (int trial = 0; trial < most_trials; ++trial) {
    std::vector<std::byte> file = search.write(search.encode(static_cast<float>(step)));
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
  Found found{std::move(best), {}};
  if (!found.file.empty()) found.report = measure(cells, found.file, options.threads);
  return found;
}

Found search_target(Search& search, const Cells& cells, const CompressOptions& options, double rmse_m) {
  if (options.target.kind == TreeClaim::bytes) return search_bytes(search, cells, options, options.target.value);
  return search_error(search, cells, options, rmse_m);
}

}  // namespace

double CompressionReport::psnr_db() const { return 20 * std::log10((highest_m - lowest_m) / rmse_m); }

CompressionReport compress(const StoredSource& source, TreeHeader header, const CompressOptions& options, const TreeWriter::Sink& sink,
                           Progress* progress) {
  const Cells cells = read_cells(source, header);
  header.claim = options.target.kind;
  header.claimed = options.target.value;
  const double range_m = std::max((cells.highest - cells.lowest) * cells.metres_per_stored, 1e-9);
  const double rmse_m = options.target.kind == TreeClaim::psnr ? range_m / std::pow(10, options.target.value / 20) : options.target.value;
  Search search(cells, header, options, progress);
  Found found = search_target(search, cells, options, rmse_m);
  if (options.node_side == 0 && !found.file.empty() && found.report.bits_per_sample() < sparse_bits_per_cell) {
    search.prepare(wide_side);
    Found wide = search_target(search, cells, options, rmse_m);
    const bool better = options.target.kind == TreeClaim::bytes ? wide.report.rmse_m < found.report.rmse_m : wide.file.size() < found.file.size();
    if (!wide.file.empty() && better) found = std::move(wide);
  }
  if (found.file.empty())
    throw Error(ErrorKind::usage, options.target.kind == TreeClaim::bytes
                                      ? "no tree of this raster fits into " + std::to_string(static_cast<std::int64_t>(options.target.value)) + " bytes: give more"
                                      : "the quality asked for is beyond what the lossy coder reaches: ask for less, or for --lossless");
  sink(found.file);
  return found.report;
}

}  // namespace arete
