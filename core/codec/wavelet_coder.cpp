#include "core/codec/wavelet_coder.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/codec/byte_stream.h"
#include "core/codec/dequantise.h"
#include "core/codec/subband_models.h"
#include "core/codec/wavelet.h"
#include "core/codec/wavelet_root.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr int reach = wavelet_reach / 2;  // in coefficients
constexpr std::int64_t tile = 256;        // coefficients along a side, of the blocks that are transformed at a time

std::int64_t tiles_along(std::int64_t n) { return (n + tile - 1) / tile; }

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

// Nodes of a level that a window of coefficients touches, decoded; none where all coefficients of a node are zero.
struct DecodedLevel {
  int level = 0;
  Window nodes;
  std::vector<std::shared_ptr<const NodeCoefficients>> coefficients;
  const NodeCoefficients* find(std::int64_t x, std::int64_t y) const {
    return coefficients[static_cast<std::size_t>((y - nodes.y) * nodes.width + (x - nodes.x))].get();
  }
};

Window touched_nodes(const NodeGrid& grid, int level, const Window& coefficients) {
  const std::int64_t side = grid.side() / 2;
  const Size nodes = grid.nodes(level);
  const std::int64_t x = coefficients.x / side, y = coefficients.y / side;
  const std::int64_t x1 = (coefficients.x + coefficients.width - 1) / side + 1, y1 = (coefficients.y + coefficients.height - 1) / side + 1;
  return {x, y, std::min(x1, nodes.width) - x, std::min(y1, nodes.height) - y};
}

// Null where all coefficients are zero.
std::shared_ptr<const NodeCoefficients> decode_coefficients(const NodeGrid& grid, const StreamReader& streams, const NodeAddress& node, const NodeCoefficients* parent) {
  const std::vector<std::byte> bytes = streams(grid.index(node));
  if (bytes.empty()) return nullptr;
  auto coefficients = std::make_shared<NodeCoefficients>(blank_coefficients(grid, node));
  SubbandModels models = initial_subband_models();
  decode_subbands(bytes, view_parent(grid, node, parent), models, *coefficients);
  return coefficients;
}

std::int64_t bytes_of(const NodeCoefficients* node) {
  if (node == nullptr) return 0;
  std::int64_t cells = 0;
  for (const CoefficientBlock& block : node->bands) cells += std::int64_t{block.stride()} * (block.height() + 2 * CoefficientBlock::border);
  return cells * static_cast<std::int64_t>(sizeof(std::int32_t) + sizeof(std::uint8_t));
}

DecodedLevel decode_level(const NodeGrid& grid, const StreamReader& streams, int level, const DecodedLevel* parents, const Window& window, int threads,
                          CoefficientCache* cache) {
  DecodedLevel decoded{level, touched_nodes(grid, level, window), {}};
  decoded.coefficients.resize(static_cast<std::size_t>(decoded.nodes.width * decoded.nodes.height));
  parallel_for(static_cast<std::int64_t>(decoded.coefficients.size()), threads, [&](std::int64_t i) {
    const NodeAddress node{level, decoded.nodes.x + i % decoded.nodes.width, decoded.nodes.y + i / decoded.nodes.width};
    std::shared_ptr<const NodeCoefficients>& coefficients = decoded.coefficients[static_cast<std::size_t>(i)];
    if (cache != nullptr && cache->find(grid.index(node), coefficients)) return;
    coefficients = decode_coefficients(grid, streams, node, parents ? parents->find(node.x / 2, node.y / 2) : nullptr);
    if (cache != nullptr) cache->keep(grid.index(node), coefficients, bytes_of(coefficients.get()));
  });
  return decoded;
}

// Positions of one axis that stand for `count` ones from `first` on, of the coefficients with one parity in a signal of `size`
// samples; -1 where there is none: in signals of one sample, and beyond what the samples between the margins depend on.
std::vector<std::int64_t> mirrored_positions(std::int64_t first, std::int64_t count, int parity, std::int64_t size) {
  std::vector<std::int64_t> positions(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t sample = mirrored_index(2 * (first + i) + parity, size);
    const std::int64_t position = sample / 2 - first;
    positions[static_cast<std::size_t>(i)] = sample % 2 == parity && position >= 0 && position < count ? position : -1;
  }
  return positions;
}

// Fills what of a padded block of coefficients lies outside the signal. `inside` is the part that is there, in the block's columns and rows.
void fill_mirrored(RasterView<float> block, const Window& inside, const std::vector<std::int64_t>& columns, const std::vector<std::int64_t>& rows) {
  const auto fill_columns = [&](float* row, std::int64_t begin, std::int64_t end) {
    for (std::int64_t x = begin; x < end; ++x) {
      const std::int64_t from = columns[static_cast<std::size_t>(x)];
      row[x] = from < 0 ? 0.0F : row[from];
    }
  };
  for (std::int64_t y = inside.y; y < inside.y + inside.height; ++y) {
    fill_columns(block.row(y), 0, inside.x);
    fill_columns(block.row(y), inside.x + inside.width, block.width);
  }
  for (std::int64_t y = 0; y < block.height; ++y) {
    if (y >= inside.y && y < inside.y + inside.height) continue;
    const std::int64_t from = rows[static_cast<std::size_t>(y)];
    if (from < 0)
      std::fill_n(block.row(y), block.width, 0.0F);
    else
      std::copy_n(block.row(from), block.width, block.row(y));
  }
}

// The part of a window that lies in another, as seen from the window's corner.
Window part_inside(const Window& window, const Window& other) {
  const std::int64_t x0 = std::max(window.x, other.x), x1 = std::min(window.x + window.width, other.x + other.width);
  const std::int64_t y0 = std::max(window.y, other.y), y1 = std::min(window.y + window.height, other.y + other.height);
  return {x0 - window.x, y0 - window.y, std::max<std::int64_t>(0, x1 - x0), std::max<std::int64_t>(0, y1 - y0)};
}

// A level on its way down: what its samples are made of.
struct Synthesis {
  const WaveletParameters& parameters;
  const DecodedLevel& nodes;
  const Raster<float>& low;  // of the window `at`
  Window at;                 // in coefficients
  Size fine;                 // of the level to come
};

Dequantiser dequantiser_of(const WaveletParameters& parameters, int level, int band) {
  Dequantiser dequantiser{{}, parameters.step / band_norm(level, band)};
  for (std::size_t k = 1; k < 4; ++k) dequantiser.shrink[k] = static_cast<float>(parameters.shrink[k - 1]) / 256;
  return dequantiser;
}

// Details of a block inside its band, node by node. False where all of them are zero: then nothing is written.
bool dequantise_inside(const Synthesis& level, int band, const Window& at, const Window& inside, RasterView<float> block) {
  const Dequantiser dequantiser = dequantiser_of(level.parameters, level.nodes.level, band);
  const std::int64_t side = level.parameters.grid.side() / 2;
  const Window cells{at.x + inside.x, at.y + inside.y, inside.width, inside.height};
  if (cells.width == 0 || cells.height == 0) return false;
  const Window nodes = touched_nodes(level.parameters.grid, level.nodes.level, cells);
  bool any = false;
  for (std::int64_t i = 0; i < nodes.width * nodes.height && !any; ++i) any = level.nodes.find(nodes.x + i % nodes.width, nodes.y + i / nodes.width) != nullptr;
  if (!any) return false;
  for (std::int64_t i = 0; i < nodes.width * nodes.height; ++i) {
    const Window node{(nodes.x + i % nodes.width) * side, (nodes.y + i / nodes.width) * side, side, side};
    const Window part = part_inside(cells, node);
    const NodeCoefficients* coefficients = level.nodes.find(node.x / side, node.y / side);
    for (std::int64_t y = part.y; y < part.y + part.height; ++y) {
      float* to = block.row(inside.y + y) + inside.x + part.x;
      if (coefficients)
        dequantise_row(dequantiser, coefficients->bands[static_cast<std::size_t>(band)].row(static_cast<int>(cells.y + y - node.y)) + (cells.x + part.x - node.x), to, part.width);
      else
        std::fill_n(to, part.width, 0.0F);
    }
  }
  return true;
}

// The coefficients of one band, or the low-pass one, that a block of samples depends on.
class PaddedBand {
 public:
  PaddedBand(const Synthesis& level, int band, const Window& at) {
    const int odd_x = band == 0 || band == 2, odd_y = band == 1 || band == 2;
    const Size size = band_size(level.fine, band);
    const Window inside = part_inside(at, part_of(level.at, size));
    if (band == band_count && inside == Window{0, 0, at.width, at.height}) {
      view_ = level.low.view().sub({at.x - level.at.x, at.y - level.at.y, at.width, at.height});
      return;
    }
    cells_ = Raster<float>(at.width, at.height);
    view_ = cells_.view();
    if (band == band_count) {
      for (std::int64_t y = inside.y; y < inside.y + inside.height; ++y)
        std::copy_n(level.low.view().row(at.y + y - level.at.y) + (at.x + inside.x - level.at.x), inside.width, cells_.view().row(y) + inside.x);
    } else if (!dequantise_inside(level, band, at, inside, cells_.view())) {
      // One row of zeros stands for all.
      std::fill_n(cells_.data(), at.width, 0.0F);
      view_.stride = 0;
      return;
    }
    fill_mirrored(cells_.view(), inside, mirrored_positions(at.x, at.width, odd_x, level.fine.width),
                  mirrored_positions(at.y, at.height, odd_y, level.fine.height));
  }
  RasterView<const float> view() const { return view_; }

 private:
  // What of a window of the level's coefficients a band has.
  static Window part_of(const Window& window, const Size& band) {
    return {window.x, window.y, std::min(window.width, band.width - window.x), std::min(window.height, band.height - window.y)};
  }
  Raster<float> cells_;
  RasterView<const float> view_;
};

// Samples of a tile that starts at an even corner, those of them that are wanted.
void synthesise_tile(const Synthesis& level, const Window& cells, const Window& wanted, Raster<float>& samples) {
  const std::int64_t w = (cells.width + 1) / 2, h = (cells.height + 1) / 2;
  const Window at{cells.x / 2 - reach, cells.y / 2 - reach, w + 2 * reach, h + 2 * reach};
  const PaddedBand low(level, band_count, at), horizontal(level, 0, at), vertical(level, 1, at), diagonal(level, 2, at);
  const std::array<RasterView<const float>, band_count> bands{horizontal.view(), vertical.view(), diagonal.view()};
  const Window part = part_inside(wanted, cells);
  if (part.width == 2 * w && part.height == 2 * h) {
    synthesise(low.view(), bands, samples.view().sub(part));
    return;
  }
  Raster<float> whole(2 * w, 2 * h);
  synthesise(low.view(), bands, whole.view());
  for (std::int64_t y = part.y; y < part.y + part.height; ++y)
    std::copy_n(whole.view().row(wanted.y + y - cells.y) + (wanted.x + part.x - cells.x), part.width, samples.view().row(y) + part.x);
}

Raster<float> synthesise_window(const Synthesis& level, const Window& wanted, int threads) {
  Raster<float> samples(wanted.width, wanted.height);
  const std::int64_t x0 = wanted.x & ~std::int64_t{1}, y0 = wanted.y & ~std::int64_t{1};
  const std::int64_t wide = tiles_along(wanted.x + wanted.width - x0), high = tiles_along(wanted.y + wanted.height - y0);
  parallel_for(wide * high, threads, [&](std::int64_t i) {
    const std::int64_t x = x0 + i % wide * tile, y = y0 + i / wide * tile;
    const Window cells{x, y, std::min(tile, wanted.x + wanted.width - x), std::min(tile, wanted.y + wanted.height - y)};
    synthesise_tile(level, cells, wanted, samples);
  });
  return samples;
}

}  // namespace

Window node_band(const NodeGrid& grid, const NodeAddress& node, int band) {
  const Size size = band_size(grid.level_size(node.level - 1), band);
  const std::int64_t side = grid.side() / 2;
  const std::int64_t x = node.x * side, y = node.y * side;
  return {x, y, std::clamp<std::int64_t>(size.width - x, 0, side), std::clamp<std::int64_t>(size.height - y, 0, side)};
}

NodeCoefficients blank_coefficients(const NodeGrid& grid, const NodeAddress& node) {
  NodeCoefficients blocks;
  for (int b = 0; b < band_count; ++b) {
    const Window at = node_band(grid, node, b);
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
  if (parameters.flat) out.put_u8(1);
  return out.take();
}

WaveletParameters decode_wavelet_parameters(std::span<const std::byte> bytes, const NodeGrid& grid, const std::string& name) {
  ByteReader in(bytes, name);
  WaveletParameters parameters{grid, in.get<float>(), {}, false};
  for (std::uint8_t& shrink : parameters.shrink) shrink = in.get_u8();
  if (!std::isfinite(parameters.step) || !(parameters.step > 0)) in.fail("its quantiser step is not a positive number");
  if (in.left() > 0) {
    if (in.get_u8() != 1) in.fail("a flag of its parameters is neither there nor absent");
    parameters.flat = true;
  }
  if (in.left() != 0) in.fail("its parameters go on after their end");
  return parameters;
}

Raster<float> decode_wavelet(const WaveletParameters& parameters, std::span<const std::byte> root, const StreamReader& streams, int level,
                             const Window& window, int threads, CoefficientCache* cache) {
  const NodeGrid& grid = parameters.grid;
  std::vector<Window> windows{window};  // of samples, from the wanted level to the root
  for (int l = level + 1; l <= grid.levels(); ++l) windows.push_back(coefficient_window(windows.back(), grid.level_size(l)));
  const Raster<float> whole_root = decode_wavelet_root(root, parameters);
  const Window& first = windows.back();
  Raster<float> samples(first.width, first.height);
  for (std::int64_t y = 0; y < first.height; ++y) std::copy_n(whole_root.view().row(first.y + y) + first.x, first.width, samples.view().row(y));
  DecodedLevel parents;
  for (int l = grid.levels(); l > level; --l) {
    const Window& at = windows[static_cast<std::size_t>(l - level)];
    DecodedLevel nodes = decode_level(grid, streams, l, l < grid.levels() ? &parents : nullptr, at, threads, cache);
    samples = synthesise_window({parameters, nodes, samples, at, grid.level_size(l - 1)}, windows[static_cast<std::size_t>(l - 1 - level)], threads);
    parents = std::move(nodes);
  }
  return samples;
}

}  // namespace arete
