#include "core/codec/wavelet_coder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/codec/byte_stream.h"
#include "core/codec/quantise.h"
#include "core/codec/subband_models.h"
#include "core/codec/wavelet.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr int reach = wavelet_reach / 2;  // in coefficients
constexpr std::int64_t tile = 256;        // coefficients along a side, of the blocks that are transformed at a time

std::int64_t tiles_along(std::int64_t n) { return (n + tile - 1) / tile; }

// --- analysis

void analyse_tile(RasterView<const float> samples, const Window& at, RasterView<float> low, std::array<Raster<float>, band_count>& bands) {
  Raster<float> padded(2 * (at.width + 2 * reach), 2 * (at.height + 2 * reach));
  for (std::int64_t y = 0; y < padded.height(); ++y) {
    const float* from = samples.row(mirrored_index(2 * (at.y - reach) + y, samples.height));
    for (std::int64_t x = 0; x < padded.width(); ++x) padded(x, y) = from[mirrored_index(2 * (at.x - reach) + x, samples.width)];
  }
  std::array<Raster<float>, band_count> parts;
  for (Raster<float>& part : parts) part = Raster<float>(at.width, at.height);
  analyse(padded.view(), low.sub(at), {parts[0].view(), parts[1].view(), parts[2].view()});
  for (std::size_t b = 0; b < band_count; ++b)
    for (std::int64_t y = 0; y < std::min(at.height, bands[b].height() - at.y); ++y)
      for (std::int64_t x = 0; x < std::min(at.width, bands[b].width() - at.x); ++x) bands[b](at.x + x, at.y + y) = parts[b](x, y);
}

// --- the root: quantised low-pass values, each as its difference to the one before

std::vector<std::byte> encode_root(const Raster<float>& root, float step) {
  RangeEncoder encoder;
  BitModel exponent[40];
  std::int64_t before = 0;
  for (std::int64_t i = 0; i < root.size().cells(); ++i) {
    const auto value = static_cast<std::int64_t>(std::llround(root.data()[i] / step));
    const std::int64_t difference = value - before;
    const std::uint64_t folded = difference < 0 ? 2 * static_cast<std::uint64_t>(-difference) - 1 : 2 * static_cast<std::uint64_t>(difference);
    const int bits = std::bit_width(folded);
    for (int b = 0; b < 39; ++b) {
      encoder.encode(bits > b, std::clamp<Probability>(exponent[b].p(), 16, 65520));
      exponent[b].update(bits > b, 60);
      if (bits <= b) break;
    }
    for (int b = bits - 2; b >= 0; --b) encoder.encode(static_cast<int>((folded >> b) & 1), 1U << 15);
    before = value;
  }
  return encoder.finish();
}

Raster<float> decode_root(std::span<const std::byte> bytes, const Size& size, float step) {
  RangeDecoder decoder(bytes);
  BitModel exponent[40];
  Raster<float> root(size.width, size.height);
  std::int64_t before = 0;
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    int bits = 0;
    while (bits < 39) {
      const int more = decoder.decode(std::clamp<Probability>(exponent[bits].p(), 16, 65520));
      exponent[bits].update(more, 60);
      if (!more) break;
      ++bits;
    }
    std::uint64_t folded = bits > 0 ? 1 : 0;
    for (int b = bits - 2; b >= 0; --b) folded = 2 * folded + static_cast<std::uint64_t>(decoder.decode(1U << 15));
    const auto half = static_cast<std::int64_t>((folded + 1) / 2);
    before += folded % 2 ? -half : half;
    root.data()[i] = static_cast<float>(before) * step;
  }
  return root;
}

float root_step(const WaveletParameters& parameters) {
  return 2 * parameters.step / band_norm(std::max(1, parameters.grid.levels()), band_count);
}

// --- nodes

// The coefficients of a band that a node holds.
Window node_window(const NodeGrid& grid, const NodeAddress& node, const Size& band) {
  const std::int64_t side = grid.side() / 2;
  const std::int64_t x = node.x * side, y = node.y * side;
  return {x, y, std::clamp<std::int64_t>(band.width - x, 0, side), std::clamp<std::int64_t>(band.height - y, 0, side)};
}

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
  NodeCoefficients coefficients;
  std::vector<std::byte> bytes;
  ShrinkSums sums;
};

bool all_off(const NodeCoefficients& node) {
  for (const CoefficientBlock& block : node.bands)
    for (int y = 0; y < block.squares_high(); ++y)
      if (std::any_of(block.flags(y), block.flags(y) + block.squares_wide(), [](std::uint8_t f) { return f != 0; })) return false;
  return true;
}

CodedNode code_node(const WaveletPyramid& pyramid, const NodeAddress& node, const ParentView& parent, float step, float lambda, int passes) {
  std::array<Raster<float>, band_count> scaled;
  std::array<RasterView<const float>, band_count> views;
  for (int b = 0; b < band_count; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const Raster<float>& band = pyramid.bands[static_cast<std::size_t>(node.level - 1)][i];
    const Window at = node_window(pyramid.grid, node, band.size());
    const float scale = band_norm(node.level, b) / step;
    scaled[i] = Raster<float>(at.width, at.height);
    for (std::int64_t y = 0; y < at.height; ++y)
      for (std::int64_t x = 0; x < at.width; ++x) scaled[i](x, y) = band(at.x + x, at.y + y) * scale;
    views[i] = scaled[i].view();
  }
  CodedNode coded{quantise_node(views, parent, lambda, passes), {}, {}};
  for (std::size_t b = 0; b < band_count; ++b)
    for (int y = 0; y < coded.coefficients.bands[b].height(); ++y)
      for (int x = 0; x < coded.coefficients.bands[b].width(); ++x) coded.sums.add(scaled[b](x, y), coded.coefficients.bands[b].row(y)[x]);
  if (all_off(coded.coefficients)) return coded;
  SubbandModels models = initial_subband_models();
  coded.bytes = encode_subbands(coded.coefficients, parent, models);
  // An empty stream would mean a node without coefficients.
  if (coded.bytes.empty()) coded.bytes.push_back(std::byte{0});
  return coded;
}

// --- synthesis

// The coefficients of a window of a level, with the window they are of.
struct LevelCoefficients {
  Window window;
  std::array<Raster<float>, band_count> bands;
};

// The window of coefficients that a window of samples depends on.
Window coefficient_window(const Window& samples, const Size& coarse) {
  const auto range = [](std::int64_t start, std::int64_t count, std::int64_t size) {
    const std::int64_t first = std::max<std::int64_t>(0, (start >> 1) - reach);
    const std::int64_t last = std::min<std::int64_t>(size - 1, ((start + count - 1) >> 1) + reach);
    return std::pair{first, last - first + 1};
  };
  const auto [x, w] = range(samples.x, samples.width, coarse.width);
  const auto [y, h] = range(samples.y, samples.height, coarse.height);
  return {x, y, w, h};
}

// Where the coefficients of one axis are found in a window: offsets for positions first - reach ... of one parity, or -1
// where a mirrored position belongs to the other parity (only in signals of one sample).
std::vector<std::int64_t> mirrored_offsets(std::int64_t first, std::int64_t count, int parity, std::int64_t size, std::int64_t origin) {
  std::vector<std::int64_t> offsets(static_cast<std::size_t>(count + 2 * reach));
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const std::int64_t sample = mirrored_index(2 * (first - reach + static_cast<std::int64_t>(i)) + parity, size);
    offsets[i] = sample % 2 == parity ? sample / 2 - origin : -1;
  }
  return offsets;
}

Raster<float> gather(const Raster<float>& band, const std::vector<std::int64_t>& columns, const std::vector<std::int64_t>& rows) {
  Raster<float> padded(static_cast<std::int64_t>(columns.size()), static_cast<std::int64_t>(rows.size()));
  for (std::size_t y = 0; y < rows.size(); ++y) {
    float* to = padded.view().row(static_cast<std::int64_t>(y));
    if (rows[y] < 0) {
      std::fill_n(to, columns.size(), 0.0F);
      continue;
    }
    const float* from = band.view().row(rows[y]);
    for (std::size_t x = 0; x < columns.size(); ++x) to[x] = columns[x] < 0 ? 0.0F : from[columns[x]];
  }
  return padded;
}

// Samples of a tile that starts at an even corner.
void synthesise_tile(const Raster<float>& low, const LevelCoefficients& coefficients, const Size& fine, const Window& tile_cells,
                     const Window& wanted, Raster<float>& samples) {
  const std::int64_t x = tile_cells.x / 2, y = tile_cells.y / 2, w = (tile_cells.width + 1) / 2, h = (tile_cells.height + 1) / 2;
  const Window& at = coefficients.window;
  const std::array<std::vector<std::int64_t>, 2> columns{mirrored_offsets(x, w, 0, fine.width, at.x), mirrored_offsets(x, w, 1, fine.width, at.x)};
  const std::array<std::vector<std::int64_t>, 2> rows{mirrored_offsets(y, h, 0, fine.height, at.y), mirrored_offsets(y, h, 1, fine.height, at.y)};
  const Raster<float> padded_low = gather(low, columns[0], rows[0]);
  const Raster<float> horizontal = gather(coefficients.bands[0], columns[1], rows[0]);
  const Raster<float> vertical = gather(coefficients.bands[1], columns[0], rows[1]);
  const Raster<float> diagonal = gather(coefficients.bands[2], columns[1], rows[1]);
  Raster<float> cells(2 * w, 2 * h);
  synthesise(padded_low.view(), {horizontal.view(), vertical.view(), diagonal.view()}, cells.view());
  const std::int64_t x0 = std::max(wanted.x, tile_cells.x), x1 = std::min(wanted.x + wanted.width, tile_cells.x + tile_cells.width);
  const std::int64_t y0 = std::max(wanted.y, tile_cells.y), y1 = std::min(wanted.y + wanted.height, tile_cells.y + tile_cells.height);
  for (std::int64_t row = y0; row < y1; ++row)
    std::copy_n(cells.view().row(row - tile_cells.y) + (x0 - tile_cells.x), x1 - x0, samples.view().row(row - wanted.y) + (x0 - wanted.x));
}

Raster<float> synthesise_window(const Raster<float>& low, const LevelCoefficients& coefficients, const Size& fine, const Window& wanted, int threads) {
  Raster<float> samples(wanted.width, wanted.height);
  const std::int64_t x0 = wanted.x & ~std::int64_t{1}, y0 = wanted.y & ~std::int64_t{1};
  const std::int64_t wide = tiles_along(wanted.x + wanted.width - x0), high = tiles_along(wanted.y + wanted.height - y0);
  parallel_for(wide * high, threads, [&](std::int64_t i) {
    const std::int64_t x = x0 + i % wide * tile, y = y0 + i / wide * tile;
    const Window cells{x, y, std::min(tile, wanted.x + wanted.width - x), std::min(tile, wanted.y + wanted.height - y)};
    synthesise_tile(low, coefficients, fine, cells, wanted, samples);
  });
  return samples;
}

void dequantise(const WaveletParameters& parameters, const NodeAddress& node, const NodeCoefficients& coefficients, LevelCoefficients& to) {
  const Size fine = parameters.grid.level_size(node.level - 1);
  for (int b = 0; b < band_count; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const float scale = parameters.step / band_norm(node.level, b);
    std::array<float, 4> offsets{};
    for (std::size_t k = 1; k < 4; ++k) offsets[k] = static_cast<float>(parameters.shrink[k - 1]) / 256;
    const Window at = node_window(parameters.grid, node, band_size(fine, b));
    const std::int64_t x0 = std::max(at.x, to.window.x), x1 = std::min(at.x + at.width, to.window.x + to.window.width);
    const std::int64_t y0 = std::max(at.y, to.window.y), y1 = std::min(at.y + at.height, to.window.y + to.window.height);
    for (std::int64_t y = y0; y < y1; ++y) {
      const std::int32_t* from = coefficients.bands[i].row(static_cast<int>(y - at.y));
      float* row = to.bands[i].view().row(y - to.window.y);
      for (std::int64_t x = x0; x < x1; ++x) {
        const std::int32_t point = from[x - at.x];
        if (point == 0) continue;
        const std::int32_t magnitude = point < 0 ? -point : point;
        const float size = (static_cast<float>(magnitude) - offsets[static_cast<std::size_t>(std::min(magnitude, 3))]) * scale;
        row[x - to.window.x] = point < 0 ? -size : size;
      }
    }
  }
}

// Nodes of a level that a window of coefficients touches, decoded.
struct DecodedLevel {
  Window nodes;
  std::vector<NodeCoefficients> coefficients;
  const NodeCoefficients* find(std::int64_t x, std::int64_t y) const {
    return &coefficients[static_cast<std::size_t>((y - nodes.y) * nodes.width + (x - nodes.x))];
  }
};

Window touched_nodes(const NodeGrid& grid, const Window& coefficients) {
  const std::int64_t side = grid.side() / 2;
  const std::int64_t x = coefficients.x / side, y = coefficients.y / side;
  return {x, y, (coefficients.x + coefficients.width - 1) / side - x + 1, (coefficients.y + coefficients.height - 1) / side - y + 1};
}

DecodedLevel decode_level(const WaveletParameters& parameters, const StreamReader& streams, int level, const DecodedLevel* parents,
                          LevelCoefficients& to, int threads) {
  const NodeGrid& grid = parameters.grid;
  DecodedLevel decoded{touched_nodes(grid, to.window), {}};
  const Size nodes = grid.nodes(level);
  decoded.nodes.width = std::min(decoded.nodes.width, nodes.width - decoded.nodes.x);
  decoded.nodes.height = std::min(decoded.nodes.height, nodes.height - decoded.nodes.y);
  decoded.coefficients.resize(static_cast<std::size_t>(decoded.nodes.width * decoded.nodes.height));
  parallel_for(static_cast<std::int64_t>(decoded.coefficients.size()), threads, [&](std::int64_t i) {
    const NodeAddress node{level, decoded.nodes.x + i % decoded.nodes.width, decoded.nodes.y + i / decoded.nodes.width};
    NodeCoefficients& coefficients = decoded.coefficients[static_cast<std::size_t>(i)] = blank_coefficients(grid, node);
    const std::vector<std::byte> bytes = streams(grid.index(node));
    if (bytes.empty()) return;
    SubbandModels models = initial_subband_models();
    decode_subbands(bytes, view_parent(grid, node, parents ? parents->find(node.x / 2, node.y / 2) : nullptr), models, coefficients);
    dequantise(parameters, node, coefficients, to);
  });
  return decoded;
}

}  // namespace

std::int64_t WaveletStreams::bytes() const {
  auto sum = static_cast<std::int64_t>(root.size());
  for (const std::vector<std::byte>& node : nodes) sum += static_cast<std::int64_t>(node.size());
  return sum;
}

NodeCoefficients blank_coefficients(const NodeGrid& grid, const NodeAddress& node) {
  NodeCoefficients blocks;
  for (int b = 0; b < band_count; ++b) {
    const Window at = node_window(grid, node, band_size(grid.level_size(node.level - 1), b));
    blocks.bands[static_cast<std::size_t>(b)] = CoefficientBlock(static_cast<int>(at.width), static_cast<int>(at.height));
  }
  return blocks;
}

ParentView view_parent(const NodeGrid& grid, const NodeAddress& node, const NodeCoefficients* parent) {
  const int half = grid.side() / 4;
  return {parent, static_cast<int>(node.x % 2) * half, static_cast<int>(node.y % 2) * half};
}

std::vector<std::byte> encode_wavelet_parameters(const WaveletParameters& parameters) {
  ByteWriter out;
  out.put(parameters.step);
  for (std::uint8_t shrink : parameters.shrink) out.put_u8(shrink);
  return out.take();
}

WaveletParameters decode_wavelet_parameters(std::span<const std::byte> bytes, const NodeGrid& grid, const std::string& name) {
  ByteReader in(bytes, name);
  WaveletParameters parameters{grid, in.get<float>(), {}};
  for (std::uint8_t& shrink : parameters.shrink) shrink = in.get_u8();
  if (!std::isfinite(parameters.step) || !(parameters.step > 0)) in.fail("its quantiser step is not a positive number");
  if (in.left() != 0) in.fail("its parameters go on after their end");
  return parameters;
}

WaveletPyramid analyse_raster(RasterView<const float> cells, const NodeGrid& grid, int threads) {
  WaveletPyramid pyramid{grid, {}, {}};
  Raster<float> samples;
  RasterView<const float> fine = cells;
  for (int level = 1; level <= grid.levels(); ++level) {
    const Size size = grid.level_size(level);
    Raster<float> low(size.width, size.height);
    std::array<Raster<float>, band_count>& bands = pyramid.bands.emplace_back();
    for (int b = 0; b < band_count; ++b) {
      const Size band = band_size(fine.size(), b);
      bands[static_cast<std::size_t>(b)] = Raster<float>(band.width, band.height);
    }
    const std::int64_t wide = tiles_along(size.width), high = tiles_along(size.height);
    parallel_for(wide * high, threads, [&](std::int64_t i) {
      const std::int64_t x = i % wide * tile, y = i / wide * tile;
      analyse_tile(fine, {x, y, std::min(tile, size.width - x), std::min(tile, size.height - y)}, low.view(), bands);
    });
    samples = std::move(low);
    fine = samples.view();
  }
  if (grid.levels() == 0) {
    samples = Raster<float>(cells.width, cells.height);
    for (std::int64_t y = 0; y < cells.height; ++y) std::copy_n(cells.row(y), cells.width, samples.view().row(y));
  }
  pyramid.root = std::move(samples);
  return pyramid;
}

WaveletStreams encode_wavelet(const WaveletPyramid& pyramid, float step, float lambda, int passes, int threads) {
  const NodeGrid& grid = pyramid.grid;
  WaveletStreams streams;
  streams.parameters = {grid, step, {}};
  streams.root = encode_root(pyramid.root, root_step(streams.parameters));
  streams.nodes.resize(static_cast<std::size_t>(grid.node_count()));
  ShrinkSums total;
  std::vector<CodedNode> parents;
  for (int level = grid.levels(); level >= 1; --level) {
    const Size nodes = grid.nodes(level);
    const std::int64_t parents_wide = level < grid.levels() ? grid.nodes(level + 1).width : 0;
    std::vector<CodedNode> coded(static_cast<std::size_t>(nodes.cells()));
    parallel_for(nodes.cells(), threads, [&](std::int64_t i) {
      const NodeAddress node{level, i % nodes.width, i / nodes.width};
      const NodeCoefficients* parent =
          level < grid.levels() ? &parents[static_cast<std::size_t>(node.y / 2 * parents_wide + node.x / 2)].coefficients : nullptr;
      coded[static_cast<std::size_t>(i)] = code_node(pyramid, node, view_parent(grid, node, parent), step, lambda, passes);
    });
    for (std::int64_t i = 0; i < nodes.cells(); ++i) {
      CodedNode& node = coded[static_cast<std::size_t>(i)];
      total.add(node.sums);
      streams.nodes[static_cast<std::size_t>(grid.index({level, i % nodes.width, i / nodes.width}))] = std::move(node.bytes);
    }
    parents = std::move(coded);
  }
  streams.squared_error = total.squares * step * step;
  for (std::size_t i = 0; i < 3; ++i) {
    if (total.count[i] == 0) continue;
    const double shift = total.excess[i] / total.count[i];
    streams.parameters.shrink[i] = static_cast<std::uint8_t>(std::clamp(std::lround(256 * shift), 0L, 255L));
    const double used = streams.parameters.shrink[i] / 256.0;
    streams.squared_error -= total.count[i] * (2 * used * shift - used * used) * step * step;
  }
  return streams;
}

Raster<float> decode_wavelet(const WaveletParameters& parameters, std::span<const std::byte> root, const StreamReader& streams, int level,
                             const Window& window, int threads) {
  const NodeGrid& grid = parameters.grid;
  std::vector<Window> windows{window};  // of samples, from the wanted level to the root
  for (int l = level + 1; l <= grid.levels(); ++l) windows.push_back(coefficient_window(windows.back(), grid.level_size(l)));
  const Raster<float> whole_root = decode_root(root, grid.level_size(grid.levels()), root_step(parameters));
  const Window& first = windows.back();
  Raster<float> samples(first.width, first.height);
  for (std::int64_t y = 0; y < first.height; ++y) std::copy_n(whole_root.view().row(first.y + y) + first.x, first.width, samples.view().row(y));
  DecodedLevel parents;
  for (int l = grid.levels(); l > level; --l) {
    LevelCoefficients coefficients{windows[static_cast<std::size_t>(l - level)], {}};
    const Window& at = coefficients.window;
    for (Raster<float>& band : coefficients.bands) band = Raster<float>(at.width, at.height, 0.0F);
    DecodedLevel decoded = decode_level(parameters, streams, l, l < grid.levels() ? &parents : nullptr, coefficients, threads);
    parents = std::move(decoded);
    samples = synthesise_window(samples, coefficients, grid.level_size(l - 1), windows[static_cast<std::size_t>(l - 1 - level)], threads);
  }
  return samples;
}

}  // namespace arete
