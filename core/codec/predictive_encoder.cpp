#include "core/codec/predictive_encoder.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/codec/predict_part.h"
#include "core/codec/predict_root.h"
#include "core/codec/predict_training.h"
#include "core/support/parallel.h"
#include "core/terrain/cell_store.h"

namespace arete {
namespace {

constexpr std::int64_t batch = 128;  // nodes or tiles that are worked on before results are gathered
constexpr std::int64_t tile = 512;   // cells along a side, of the blocks that levels are made of

// The levels of a raster: level 0 is the source, each coarser one is at first what the source has there, and what the decoder will
// have once the level is coded.
class Levels {
 public:
  Levels(const NumberSource& source, const NodeGrid& grid, const Scratch& scratch) : source_(source), grid_(grid) {
    for (int l = 1; l <= grid.levels(); ++l) {
      values_.emplace_back(grid.level_size(l), scratch, scratch.memory_bytes / 4);
      if (source.any_void()) voids_.emplace_back(grid.level_size(l), scratch, scratch.memory_bytes / 16);
    }
  }

  LevelPart read(int level, const Window& window) const {
    LevelPart cells{Raster<std::int32_t>(window.width, window.height), {}, window.x, window.y};
    if (source_.any_void()) cells.voids = Raster<std::uint8_t>(window.width, window.height);
    if (level == 0) {
      source_.read(window, cells.values.view(), source_.any_void() ? cells.voids.view() : RasterView<std::uint8_t>{});
    } else {
      values_[index(level)].read(window, cells.values.view());
      if (source_.any_void()) voids_[index(level)].read(window, cells.voids.view());
    }
    return cells;
  }

  void write(int level, const Window& window, const Raster<std::int32_t>& values) {
    if (level > 0) values_[index(level)].write(window, values.view());
  }
  void write(int level, const Window& window, const LevelPart& cells) {
    write(level, window, cells.values);
    if (source_.any_void()) voids_[index(level)].write(window, cells.voids.view());
  }

 private:
  static std::size_t index(int level) { return static_cast<std::size_t>(level - 1); }
  const NumberSource& source_;
  const NodeGrid& grid_;
  std::vector<CellStore<std::int32_t>> values_;
  std::vector<CellStore<std::uint8_t>> voids_;
};

struct Range {
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest = std::numeric_limits<std::int32_t>::min();
  void add(const Range& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
  }
};

// Of the cells that are not void.
Range range_of(const LevelPart& cells) {
  Range range;
  for (std::int64_t i = 0; i < cells.values.size().cells(); ++i)
    if (cells.voids.size().cells() == 0 || cells.voids.data()[i] == 0) range.add({cells.values.data()[i], cells.values.data()[i]});
  return range;
}

LevelPart every_second(const LevelPart& fine, const Size& size) {
  LevelPart coarse{Raster<std::int32_t>(size.width, size.height), {}, fine.x / 2, fine.y / 2};
  const bool voids = fine.voids.size().cells() > 0;
  if (voids) coarse.voids = Raster<std::uint8_t>(size.width, size.height);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < size.width; ++x) {
      coarse.values(x, y) = fine.values(2 * x, 2 * y);
      if (voids) coarse.voids(x, y) = fine.voids(2 * x, 2 * y);
    }
  return coarse;
}

// Makes level l from level l - 1; gives the range of the latter.
Range make_level(Levels& levels, const NodeGrid& grid, int level, const PredictiveEncoding& how) {
  const Size fine = grid.level_size(level - 1);
  const std::int64_t wide = (fine.width + tile - 1) / tile, count = wide * ((fine.height + tile - 1) / tile);
  Range range;
  for (std::int64_t first = 0; first < count; first += batch) {
    std::vector<Range> ranges(static_cast<std::size_t>(std::min(batch, count - first)));
    parallel_for(static_cast<std::int64_t>(ranges.size()), how.threads, [&](std::int64_t i) {
      const std::int64_t x = (first + i) % wide * tile, y = (first + i) / wide * tile;
      const Window at{x, y, std::min(tile, fine.width - x), std::min(tile, fine.height - y)};
      const LevelPart cells = levels.read(level - 1, at);
      ranges[static_cast<std::size_t>(i)] = range_of(cells);
      const Window coarse{x / 2, y / 2, (at.width + 1) / 2, (at.height + 1) / 2};
      levels.write(level, coarse, every_second(cells, coarse.size()));
    });
    for (const Range& part : ranges) range.add(part);
    if (how.progress) how.progress(0);
  }
  return range;
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

std::int32_t level_step(const PredictiveEncoding& how, int level) {
  if (level < 1 || how.coarse_step.empty()) return how.step;
  const auto i = std::min(static_cast<std::size_t>(level), how.coarse_step.size()) - 1;
  return std::max<std::int32_t>(1, static_cast<std::int32_t>(std::int64_t{how.step} * how.coarse_step[i] / 256));
}

// The cells of level l that a node over `cells` of level l - 1 looks at.
Window coarse_window(const Window& cells, const Size& level) {
  const std::int64_t x0 = std::max<std::int64_t>(0, cells.x / 2 - lattice_margin), y0 = std::max<std::int64_t>(0, cells.y / 2 - lattice_margin);
  const std::int64_t x1 = std::min(level.width, (cells.x + cells.width + 1) / 2 + lattice_margin);
  const std::int64_t y1 = std::min(level.height, (cells.y + cells.height + 1) / 2 + lattice_margin);
  return {x0, y0, x1 - x0, y1 - y0};
}

// What a node is coded from.
struct NodeCells {
  Window at;     // of level l - 1
  LevelPart coarse;  // of level l, as decoded
  LevelPart truth;
};

NodeCells read_node_cells(const Levels& levels, const NodeGrid& grid, const NodeAddress& node) {
  const Window at = grid.cells(node);
  return {at, levels.read(node.level, coarse_window(at, grid.level_size(node.level))), levels.read(node.level - 1, at)};
}

LevelParameters train_level(const Levels& levels, const NodeGrid& grid, int level, const PredictParameters& file, const PredictiveEncoding& how) {
  const std::int64_t columns = grid.nodes(level).width;
  std::vector<NodeCells> samples;
  for (std::int64_t i : sample_nodes(grid, level)) samples.push_back(read_node_cells(levels, grid, {level, i % columns, i / columns}));
  std::vector<TrainingBlock> blocks;
  for (const NodeCells& node : samples) blocks.push_back({node.coarse.view(grid.level_size(level)), node.at, node.truth.block()});
  return estimate_level(blocks, file, level_step(how, level - 1), default_level_parameters(), how.threads);
}

// Codes the nodes of a level, and puts what the decoder will have in the place of level l - 1.
void code_level(Levels& levels, const NodeGrid& grid, int level, const PredictParameters& file, const PredictiveEncoding& how, const NodeStore& nodes) {
  const LevelParameters& parameters = file.levels[static_cast<std::size_t>(level - 1)];
  const Size size = grid.nodes(level);
  for (std::int64_t first = 0; first < size.cells(); first += batch) {
    std::vector<std::vector<std::byte>> streams(static_cast<std::size_t>(std::min(batch, size.cells() - first)));
    parallel_for(static_cast<std::int64_t>(streams.size()), how.threads, [&](std::int64_t i) {
      const NodeCells node = read_node_cells(levels, grid, {level, (first + i) % size.width, (first + i) / size.width});
      Raster<std::int32_t> decoded(node.at.width, node.at.height);
      streams[static_cast<std::size_t>(i)] =
          encode_node(node.coarse.view(grid.level_size(level)), node.at, file, parameters, node.truth.block(), decoded.view());
      levels.write(level - 1, node.at, decoded);
    });
    if (how.progress) how.progress(static_cast<std::int64_t>(streams.size()));
    for (std::vector<std::byte>& stream : streams) nodes.add(std::move(stream));
  }
}

}  // namespace

PredictiveSummary encode_predictive(const NumberSource& source, const NodeGrid& grid, const PredictiveEncoding& how, const NodeStore& nodes) {
  const int top = grid.levels();
  const Size root = grid.level_size(top);
  const Window all{0, 0, root.width, root.height};
  Levels levels(source, grid, how.scratch);
  Range range;
  for (int l = 1; l <= top; ++l) range.add(make_level(levels, grid, l, how));
  const LevelPart coarsest = levels.read(top, all);
  range.add(range_of(coarsest));

  PredictiveSummary summary;
  PredictParameters& file = summary.parameters;
  if (range.lowest <= range.highest) file.lowest = range.lowest, file.highest = range.highest;
  file.root_step = level_step(how, top);
  file.levels.resize(static_cast<std::size_t>(top));
  Raster<std::int32_t> decoded(root.width, root.height);
  summary.root = encode_root(file, coarsest.block(), decoded.view());
  levels.write(top, all, decoded);
  for (int l = top; l >= 1; --l) {
    file.levels[static_cast<std::size_t>(l - 1)] = train_level(levels, grid, l, file, how);
    code_level(levels, grid, l, file, how, nodes);
  }
  return summary;
}

}  // namespace arete
