#include "core/codec/predictive_coder.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>

#include "core/codec/predict_root.h"
#include "core/codec/predict_training.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

// A level, or a part of it from (x, y) on.
struct Cells {
  Raster<std::int32_t> values;
  Raster<std::uint8_t> voids;  // empty where there are none
  std::int64_t x = 0;
  std::int64_t y = 0;

  RasterView<const std::uint8_t> mask() const { return voids.size().cells() > 0 ? voids.view() : RasterView<const std::uint8_t>{}; }
  RasterView<const std::uint8_t> mask(const Window& w) const { return voids.size().cells() > 0 ? voids.view().sub(w) : mask(); }
  BlockView block(const Window& w) const { return {values.view().sub(w), mask(w)}; }
  LevelView view(const Size& level) const { return {values.view(), mask(), x, y, level}; }
};

Raster<std::int32_t> every_second(RasterView<const std::int32_t> from, const Size& size) {
  Raster<std::int32_t> to(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) to(x, y) = from(2 * x, 2 * y);
  return to;
}

Raster<std::uint8_t> every_second(RasterView<const std::uint8_t> from, const Size& size) {
  Raster<std::uint8_t> to(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) to(x, y) = from(2 * x, 2 * y);
  return to;
}

// The range of the cells that are not void.
void find_range(RasterView<const std::int32_t> values, RasterView<const std::uint8_t> voids, PredictParameters& parameters) {
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max(), highest = std::numeric_limits<std::int32_t>::min();
  for (std::int64_t y = 0; y < values.height; ++y)
    for (std::int64_t x = 0; x < values.width; ++x) {
      if (voids.data != nullptr && voids(x, y) != 0) continue;
      lowest = std::min(lowest, values(x, y));
      highest = std::max(highest, values(x, y));
    }
  parameters.lowest = lowest <= highest ? lowest : 0;
  parameters.highest = lowest <= highest ? highest : 0;
}

// The levels of the true raster; level 0 a copy.
std::vector<Cells> make_pyramid(RasterView<const std::int32_t> values, RasterView<const std::uint8_t> voids, const NodeGrid& grid) {
  std::vector<Cells> levels(static_cast<std::size_t>(grid.levels()) + 1);
  levels[0].values = Raster<std::int32_t>(values.width, values.height);
  for (std::int64_t y = 0; y < values.height; ++y) std::copy_n(values.row(y), values.width, levels[0].values.view().row(y));
  if (voids.data != nullptr) {
    levels[0].voids = Raster<std::uint8_t>(values.width, values.height);
    for (std::int64_t y = 0; y < values.height; ++y) std::copy_n(voids.row(y), values.width, levels[0].voids.view().row(y));
  }
  for (int l = 1; l <= grid.levels(); ++l) {
    const Cells& finer = levels[static_cast<std::size_t>(l - 1)];
    Cells& level = levels[static_cast<std::size_t>(l)];
    level.values = every_second(finer.values.view(), grid.level_size(l));
    if (voids.data != nullptr) level.voids = every_second(finer.mask(), grid.level_size(l));
  }
  return levels;
}

// A few nodes of a level spread evenly, of half a million cells at most: more change the parameters little.
std::vector<std::int64_t> sample_nodes(const NodeGrid& grid, int level) {
  const std::int64_t count = grid.nodes(level).cells();
  const std::int64_t wanted = std::max<std::int64_t>(1, (1 << 19) / (std::int64_t{grid.side()} * grid.side()));
  const std::int64_t taken = std::min(count, wanted);
  std::vector<std::int64_t> nodes;
  for (std::int64_t i = 0; i < taken; ++i) nodes.push_back((2 * i + 1) * count / (2 * taken));
  return nodes;
}

std::int32_t level_step(const PredictiveOptions& options, int level) {
  if (level < 1 || options.coarse_step.empty()) return options.step;
  const auto i = std::min(static_cast<std::size_t>(level), options.coarse_step.size()) - 1;
  return std::max<std::int32_t>(1, static_cast<std::int32_t>(std::int64_t{options.step} * options.coarse_step[i] / 256));
}

// All cells of a level that nodes over `window` of the level below look at.
Window needed_above(const NodeGrid& grid, int level, const Window& window) {
  const std::int64_t side = grid.side();
  const Size size = grid.level_size(level);
  const std::int64_t x0 = std::max<std::int64_t>(0, window.x / side * side / 2 - lattice_margin);
  const std::int64_t y0 = std::max<std::int64_t>(0, window.y / side * side / 2 - lattice_margin);
  const std::int64_t x1 = std::min(size.width, ((window.x + window.width + side - 1) / side * side) / 2 + lattice_margin);
  const std::int64_t y1 = std::min(size.height, ((window.y + window.height + side - 1) / side * side) / 2 + lattice_margin);
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace

std::int64_t PredictiveStreams::bytes() const {
  std::size_t sum = root.size() + encode_parameters(parameters).size();
  for (const auto& node : nodes) sum += node.size();
  return static_cast<std::int64_t>(sum);
}

PredictiveStreams encode_predictive(RasterView<const std::int32_t> values, RasterView<const std::uint8_t> voids, const NodeGrid& grid,
                                    const PredictiveOptions& options) {
  PredictiveStreams streams;
  streams.grid = grid;
  PredictParameters& file = streams.parameters;
  find_range(values, voids, file);
  const std::vector<Cells> truth = make_pyramid(values, voids, grid);
  const int top = grid.levels();
  file.root_step = level_step(options, top);
  file.levels.resize(static_cast<std::size_t>(top));
  streams.nodes.resize(static_cast<std::size_t>(grid.node_count()));

  const Size root = grid.level_size(top);
  Raster<std::int32_t> decoded(root.width, root.height);
  streams.root = encode_root(file, truth.back().block({0, 0, root.width, root.height}), decoded.view());
  for (int l = top; l >= 1; --l) {
    const Cells& wanted = truth[static_cast<std::size_t>(l - 1)];
    const LevelView coarse{decoded.view(), truth[static_cast<std::size_t>(l)].mask(), 0, 0, grid.level_size(l)};
    const std::int64_t columns = grid.nodes(l).width;
    const auto address = [&](std::int64_t i) { return NodeAddress{l, i % columns, i / columns}; };
    std::vector<TrainingBlock> blocks;
    for (std::int64_t i : sample_nodes(grid, l)) blocks.push_back({coarse, grid.cells(address(i)), wanted.block(grid.cells(address(i)))});
    LevelParameters& level = file.levels[static_cast<std::size_t>(l - 1)];
    level = estimate_level(blocks, file, level_step(options, l - 1), default_level_parameters(), options.threads);
    Raster<std::int32_t> finer(wanted.values.width(), wanted.values.height());
    parallel_for(grid.nodes(l).cells(), options.threads, [&](std::int64_t i) {
      const Window cells = grid.cells(address(i));
      streams.nodes[static_cast<std::size_t>(grid.index(address(i)))] =
          encode_node(coarse, cells, file, level, wanted.block(cells), finer.view().sub(cells));
    });
    decoded = std::move(finer);
  }
  streams.decoded = std::move(decoded);
  return streams;
}

Raster<std::int32_t> decode_predictive(const NodeGrid& grid, const PredictParameters& parameters, std::span<const std::byte> root,
                                       const StreamReader& streams, const VoidReader& voids, int level, const Window& window, int threads) {
  std::vector<Window> needed{window};
  for (int l = level + 1; l <= grid.levels(); ++l) needed.push_back(needed_above(grid, l, needed.back()));

  const std::int64_t side = grid.side();
  const Size top = grid.level_size(grid.levels());
  Cells part;
  part.values = Raster<std::int32_t>(top.width, top.height);
  if (voids) part.voids = voids(grid.levels(), {0, 0, top.width, top.height});
  decode_root(parameters, root, part.mask(), part.values.view());
  for (int l = grid.levels(); l > level; --l) {
    // whole blocks over what is needed
    const Window& w = needed[static_cast<std::size_t>(l - 1 - level)];
    const std::int64_t x0 = w.x / side, y0 = w.y / side;
    const std::int64_t wide = (w.x + w.width + side - 1) / side - x0, high = (w.y + w.height + side - 1) / side - y0;
    const Window last = grid.cells({l, x0 + wide - 1, y0 + high - 1});
    Cells finer;
    finer.x = x0 * side;
    finer.y = y0 * side;
    const Window covered{finer.x, finer.y, last.x + last.width - finer.x, last.y + last.height - finer.y};
    finer.values = Raster<std::int32_t>(covered.width, covered.height);
    if (voids) finer.voids = voids(l - 1, covered);
    const LevelView coarse = part.view(grid.level_size(l));
    parallel_for(wide * high, threads, [&](std::int64_t i) {
      const NodeAddress node{l, x0 + i % wide, y0 + i / wide};
      const Window cells = grid.cells(node);
      const Window here{cells.x - finer.x, cells.y - finer.y, cells.width, cells.height};
      decode_node(coarse, cells, parameters, parameters.levels[static_cast<std::size_t>(l - 1)], streams(grid.index(node)), finer.mask(here),
                  finer.values.view().sub(here));
    });
    part = std::move(finer);
  }
  Raster<std::int32_t> out(window.width, window.height);
  for (std::int64_t y = 0; y < window.height; ++y)
    std::copy_n(part.values.view().row(window.y + y - part.y) + (window.x - part.x), window.width, out.view().row(y));
  return out;
}

}  // namespace arete
