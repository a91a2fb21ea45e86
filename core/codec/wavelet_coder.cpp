#include "core/codec/wavelet_coder.h"

#include <algorithm>
#include <cmath>

#include "core/codec/byte_stream.h"
#include "core/codec/subband_models.h"
#include "core/codec/wavelet.h"
#include "core/codec/wavelet_root.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr int reach = wavelet_reach / 2;  // in coefficients
constexpr std::int64_t tile = 256;        // coefficients along a side, of the blocks that are transformed at a time

std::int64_t tiles_along(std::int64_t n) { return (n + tile - 1) / tile; }

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
  for (int b = 0; b < band_count; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const float scale = parameters.step / band_norm(node.level, b);
    std::array<float, 4> offsets{};
    for (std::size_t k = 1; k < 4; ++k) offsets[k] = static_cast<float>(parameters.shrink[k - 1]) / 256;
    const Window at = node_band(parameters.grid, node, b);
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
                             const Window& window, int threads) {
  const NodeGrid& grid = parameters.grid;
  std::vector<Window> windows{window};  // of samples, from the wanted level to the root
  for (int l = level + 1; l <= grid.levels(); ++l) windows.push_back(coefficient_window(windows.back(), grid.level_size(l)));
  const Raster<float> whole_root = decode_wavelet_root(root, parameters);
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
