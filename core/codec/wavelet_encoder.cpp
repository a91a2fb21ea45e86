#include "core/codec/wavelet_encoder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/codec/quantise.h"
#include "core/codec/subband_models.h"
#include "core/codec/wavelet.h"
#include "core/codec/wavelet_root.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr int reach = wavelet_reach / 2;  // in coefficients
constexpr std::int64_t tile = 256;        // coefficients along a side, of the blocks that the levels are made of
constexpr std::int64_t batch = 128;       // nodes or tiles that are worked on before results are gathered

// --- analysis

struct Analysed {
  Raster<float> low;
  std::array<Raster<float>, band_count> bands;  // beyond a band's size they mean nothing
};

// Where the samples of one axis are found from `origin` on.
std::vector<std::int64_t> mirrored_samples(std::int64_t first, std::size_t count, std::int64_t size, std::int64_t origin) {
  std::vector<std::int64_t> at(count);
  for (std::size_t i = 0; i < count; ++i) at[i] = mirrored_index(first + static_cast<std::int64_t>(i), size) - origin;
  return at;
}

// The samples, of those that there are, that a range of coefficients depends on: mirrored ones lie up to one further inside.
std::pair<std::int64_t, std::int64_t> sample_range(std::int64_t first, std::int64_t count, std::int64_t size) {
  const std::int64_t begin = std::clamp<std::int64_t>(2 * (first - reach) - 2, 0, size - 1);
  const std::int64_t end = std::min(size, 2 * (first + count + reach));
  return {begin, std::max(end, begin + 1) - begin};
}

// Coefficients (x, y) of level + 1 from the samples of `level`, in a window of them.
Analysed analyse_window(const WaveletPyramid& pyramid, int level, const Window& at) {
  const Size size = pyramid.grid.level_size(level);
  const auto [x0, wide] = sample_range(at.x, at.width, size.width);
  const auto [y0, high] = sample_range(at.y, at.height, size.height);
  const Raster<float> samples = pyramid.read(level, {x0, y0, wide, high});
  Raster<float> padded(2 * (at.width + 2 * reach), 2 * (at.height + 2 * reach));
  const std::vector<std::int64_t> columns = mirrored_samples(2 * (at.x - reach), static_cast<std::size_t>(padded.width()), size.width, x0);
  const std::vector<std::int64_t> rows = mirrored_samples(2 * (at.y - reach), static_cast<std::size_t>(padded.height()), size.height, y0);
  for (std::int64_t y = 0; y < padded.height(); ++y) {
    const float* from = samples.view().row(rows[static_cast<std::size_t>(y)]);
    float* to = padded.view().row(y);
    for (std::size_t x = 0; x < columns.size(); ++x) to[x] = from[columns[x]];
  }
  Analysed result{Raster<float>(at.width, at.height), {}};
  for (Raster<float>& band : result.bands) band = Raster<float>(at.width, at.height);
  analyse(padded.view(), result.low.view(), {result.bands[0].view(), result.bands[1].view(), result.bands[2].view()});
  return result;
}

DetailSizes measure_details(const Analysed& part, const Size& samples, int level, const Window& at) {
  DetailSizes sizes;
  for (int b = 0; b < band_count; ++b) {
    const Size band = band_size(samples, b);
    const float norm = band_norm(level, b);
    const Raster<float>& details = part.bands[static_cast<std::size_t>(b)];
    for (std::int64_t y = 0; y < std::min(at.height, band.height - at.y); ++y)
      for (std::int64_t x = 0; x < std::min(at.width, band.width - at.x); ++x) sizes.add(details(x, y) * norm);
  }
  return sizes;
}

// Level l from level l - 1, its details added to the sizes in a fixed order.
CellStore<float> analyse_level(WaveletPyramid& pyramid, int level, const Scratch& scratch, int threads, const std::function<void(std::int64_t)>& progress) {
  const Size size = pyramid.grid.level_size(level), fine = pyramid.grid.level_size(level - 1);
  CellStore<float> lows(size, scratch, scratch.memory_bytes / 4);
  const std::int64_t wide = (size.width + tile - 1) / tile, count = wide * ((size.height + tile - 1) / tile);
  for (std::int64_t first = 0; first < count; first += batch) {
    std::vector<DetailSizes> sizes(static_cast<std::size_t>(std::min(batch, count - first)));
    parallel_for(static_cast<std::int64_t>(sizes.size()), threads, [&](std::int64_t i) {
      const std::int64_t x = (first + i) % wide * tile, y = (first + i) / wide * tile;
      const Window at{x, y, std::min(tile, size.width - x), std::min(tile, size.height - y)};
      const Analysed part = analyse_window(pyramid, level - 1, at);
      lows.write(at, part.low.view());
      sizes[static_cast<std::size_t>(i)] = measure_details(part, fine, level, at);
    });
    for (const DetailSizes& part : sizes) pyramid.details.add(part);
    if (progress) progress(std::ssize(sizes) * size.cells() / count);
  }
  return lows;
}

// --- nodes

// Sums over the coefficients of a file by magnitude: how far they lie below their lattice points.
struct ShrinkSums {
  std::array<double, 3> excess{};
  std::array<double, 3> count{};
  double squares = 0;  // of the errors, in steps squared
  void add(float value, std::int32_t point) {
    const double error = std::abs(value) - static_cast<double>(std::abs(point));
    squares += error * error;
    if (point == 0) return;
    const auto i = static_cast<std::size_t>(std::min(std::abs(point), 3) - 1);
    excess[i] -= (value < 0) == (point < 0) ? error : -std::abs(value) - static_cast<double>(std::abs(point));
    count[i] += 1;
  }
  void add(const ShrinkSums& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      excess[i] += other.excess[i];
      count[i] += other.count[i];
    }
    squares += other.squares;
  }
};

struct CodedNode {
  std::vector<std::byte> bytes;
  ShrinkSums sums;
};

bool all_off(const NodeCoefficients& node) {
  for (const CoefficientBlock& block : node.bands)
    for (int y = 0; y < block.squares_high(); ++y)
      if (std::any_of(block.flags(y), block.flags(y) + block.squares_wide(), [](std::uint8_t f) { return f != 0; })) return false;
  return true;
}

CodedNode code_node(const WaveletPyramid& pyramid, const NodeAddress& node, const ParentView& parent, const WaveletEncoding& how) {
  const std::int64_t side = pyramid.grid.side() / 2;
  const Size coarse = pyramid.grid.level_size(node.level);
  const Window at{node.x * side, node.y * side, std::min(side, coarse.width - node.x * side), std::min(side, coarse.height - node.y * side)};
  Analysed part = analyse_window(pyramid, node.level - 1, at);
  std::array<RasterView<const float>, band_count> views;
  for (int b = 0; b < band_count; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const Window band = node_band(pyramid.grid, node, b);
    const float scale = band_norm(node.level, b) / how.step;
    for (std::int64_t k = 0; k < part.bands[i].size().cells(); ++k) part.bands[i].data()[k] = hold_steps(part.bands[i].data()[k] * scale, static_cast<float>(coefficient_limit));
    views[i] = part.bands[i].view().sub({0, 0, band.width, band.height});
  }
  const NodeCoefficients coefficients = quantise_node(views, parent, how.lambda, how.passes);
  CodedNode coded;
  for (std::size_t b = 0; b < band_count; ++b)
    for (int y = 0; y < coefficients.bands[b].height(); ++y)
      for (int x = 0; x < coefficients.bands[b].width(); ++x) coded.sums.add(views[b](x, y), coefficients.bands[b].row(y)[x]);
  if (all_off(coefficients)) return coded;
  SubbandModels models = initial_subband_models();
  coded.bytes = encode_subbands(coefficients, parent, models);
  // An empty stream would mean a node without coefficients.
  if (coded.bytes.empty()) coded.bytes.push_back(std::byte{0});
  return coded;
}

// The row of nodes last asked for of each level, decoded again from their streams: contexts of the nodes below them.
class ParentRows {
 public:
  ParentRows(const NodeGrid& grid, const StreamReader& streams, int threads)
      : grid_(grid), streams_(streams), threads_(threads), rows_(static_cast<std::size_t>(grid.levels()) + 1) {}

  /// Null above the coarsest nodes. Valid until another row of the level is asked for.
  const NodeCoefficients* row(int level, std::int64_t y) {
    if (level > grid_.levels()) return nullptr;
    Row& row = rows_[static_cast<std::size_t>(level)];
    if (row.y == y) return row.nodes.data();
    const NodeCoefficients* parents = this->row(level + 1, y / 2);
    row.nodes.assign(static_cast<std::size_t>(grid_.nodes(level).width), {});
    parallel_for(static_cast<std::int64_t>(row.nodes.size()), threads_, [&](std::int64_t x) {
      const NodeAddress node{level, x, y};
      NodeCoefficients& blocks = row.nodes[static_cast<std::size_t>(x)];
      blocks = blank_coefficients(grid_, node);
      const std::vector<std::byte> stream = streams_(grid_.index(node));
      if (stream.empty()) return;
      SubbandModels models = initial_subband_models();
      decode_subbands(stream, view_parent(grid_, node, parents == nullptr ? nullptr : parents + x / 2), models, blocks);
    });
    row.y = y;
    return row.nodes.data();
  }

 private:
  struct Row {
    std::int64_t y = -1;
    std::vector<NodeCoefficients> nodes;
  };
  const NodeGrid& grid_;
  const StreamReader& streams_;
  int threads_;
  std::vector<Row> rows_;
};

// Nodes from `first` on, of two rows at most that have the same parents.
void code_batch(const WaveletPyramid& pyramid, const NodeAddress& first, std::int64_t count, const NodeCoefficients* parents,
                const WaveletEncoding& how, const NodeStore& nodes, ShrinkSums& total) {
  const std::int64_t wide = pyramid.grid.nodes(first.level).width, start = first.y * wide + first.x;
  std::vector<CodedNode> coded(static_cast<std::size_t>(count));
  parallel_for(count, how.threads, [&](std::int64_t i) {
    const NodeAddress node{first.level, (start + i) % wide, (start + i) / wide};
    const ParentView parent = view_parent(pyramid.grid, node, parents == nullptr ? nullptr : parents + node.x / 2);
    coded[static_cast<std::size_t>(i)] = code_node(pyramid, node, parent, how);
  });
  for (CodedNode& node : coded) {
    total.add(node.sums);
    nodes.add(std::move(node.bytes));
  }
  if (how.progress) how.progress(count);
}

// The shrink that suits the sums, and the squared error with it.
double choose_shrink(const ShrinkSums& total, WaveletParameters& parameters) {
  const double unit = static_cast<double>(parameters.step) * static_cast<double>(parameters.step);
  double squares = total.squares * unit;
  for (std::size_t i = 0; i < 3; ++i) {
    if (total.count[i] == 0) continue;
    const double shift = total.excess[i] / total.count[i];
    parameters.shrink[i] = static_cast<std::uint8_t>(std::clamp(std::lround(256 * shift), 0L, 255L));
    const double used = parameters.shrink[i] / 256.0;
    squares -= total.count[i] * (2 * used * shift - used * used) * unit;
  }
  return squares;
}

}  // namespace

void DetailSizes::add(float detail) {
  const float square = detail * detail;
  if (!std::isfinite(square)) return;
  const std::size_t bin = std::bit_cast<std::uint32_t>(square) >> (32 - 1 - 10);  // the exponent and two bits more
  count[bin] += 1;
  squares[bin] += static_cast<double>(square);
}

void DetailSizes::add(const DetailSizes& other) {
  for (std::size_t i = 0; i < bins; ++i) {
    count[i] += other.count[i];
    squares[i] += other.squares[i];
  }
}

// The constants of both models: fitted to what came out for real terrain at 0.05 to 2 bits a cell.
double DetailSizes::squared_error(double step) const {
  double sum = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    if (count[i] == 0) continue;
    const double square = squares[i] / count[i] / (step * step);
    sum += (square < 0.8 ? square : square < 6 ? 0.3 : 0.2) * step * step * count[i];
  }
  return sum;
}

double DetailSizes::bits(double step) const {
  double sum = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    if (count[i] == 0) continue;
    const double square = squares[i] / count[i] / (step * step);
    sum += count[i] * (square < 1 ? 2.2 * square : 2.2 + 0.45 * std::log2(square));
  }
  return sum;
}

double DetailSizes::least_step() const {
  for (std::size_t i = bins; i-- > 0;)
    if (squares[i] > 0) return 2 * std::sqrt(squares[i] / count[i]) / coefficient_limit;
  return 0;
}

Raster<float> WaveletPyramid::read(int level, const Window& window) const {
  if (level > 0) return lows[static_cast<std::size_t>(level - 1)].read(window);
  Raster<float> samples(window.width, window.height);
  cells->read(window, samples.view());
  return samples;
}

WaveletPyramid analyse_raster(const RasterSource& cells, const NodeGrid& grid, const Scratch& scratch, int threads,
                              const std::function<void(std::int64_t)>& progress) {
  WaveletPyramid pyramid{grid, &cells, {}, {}};
  for (int level = 1; level <= grid.levels(); ++level) pyramid.lows.push_back(analyse_level(pyramid, level, scratch, threads, progress));
  return pyramid;
}

WaveletSummary encode_wavelet(const WaveletPyramid& pyramid, const WaveletEncoding& how, const NodeStore& nodes) {
  const NodeGrid& grid = pyramid.grid;
  WaveletSummary summary;
  summary.parameters = {grid, how.step, {}};
  const Size root = grid.level_size(grid.levels());
  summary.root = encode_wavelet_root(pyramid.read(grid.levels(), {0, 0, root.width, root.height}), summary.parameters);
  ShrinkSums total;
  for (int level = grid.levels(); level >= 1; --level) {
    ParentRows rows(grid, nodes.read, how.threads);
    const Size count = grid.nodes(level);
    for (std::int64_t y = 0; y < count.height; y += 2) {
      const NodeCoefficients* parents = rows.row(level + 1, y / 2);
      const std::int64_t end = std::min(count.height, y + 2) * count.width;
      for (std::int64_t i = y * count.width; i < end; i += batch)
        code_batch(pyramid, {level, i % count.width, i / count.width}, std::min(batch, end - i), parents, how, nodes, total);
    }
  }
  summary.squared_error = choose_shrink(total, summary.parameters);
  return summary;
}

}  // namespace arete
