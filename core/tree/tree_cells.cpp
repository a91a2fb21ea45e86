#include "core/tree/tree_cells.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <utility>

#include "core/codec/flat_coder.h"
#include "core/codec/void_mask_coder.h"
#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/fill_voids.h"

namespace arete {
namespace {

constexpr std::int64_t tile = 1024;      // cells along a side, of the parts that rasters are gone through by
constexpr std::int64_t one_fill = 2048;  // rasters up to this are filled in one
constexpr std::int64_t fill_halo = 128;

class HeldCells final : public StoredSource {
 public:
  explicit HeldCells(Raster<double> stored) : stored_(std::move(stored)) {}
  Size size() const override { return stored_.size(); }
  void read_stored(const Window& window, RasterView<double> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y) std::copy_n(stored_.view().row(window.y + y) + window.x, window.width, out.row(y));
  }

 private:
  Raster<double> stored_;
};

std::shared_ptr<const StoredSource> hold_cells(const StoredSource& source, const Scratch& scratch) {
  const Size size = source.size();
  if (size.cells() > scratch.memory_bytes / 4 / static_cast<std::int64_t>(sizeof(double))) return {std::shared_ptr<void>(), &source};
  Raster<double> stored(size.width, size.height);
  source.read_stored({0, 0, size.width, size.height}, stored.view());
  return std::make_shared<HeldCells>(std::move(stored));
}

Raster<double> read_window(const StoredSource& source, const Window& window) {
  Raster<double> cells(window.width, window.height);
  source.read_stored(window, cells.view());
  return cells;
}

void visit_windows(const Size& size, std::int64_t side, const std::function<void(const Window&)>& visit) {
  for (std::int64_t y = 0; y < size.height; y += side)
    for (std::int64_t x = 0; x < size.width; x += side) visit({x, y, std::min(side, size.width - x), std::min(side, size.height - y)});
}

// A window with a halo, as far as the raster goes.
Window widen(const Window& window, std::int64_t halo, const Size& size) {
  const std::int64_t x0 = std::max<std::int64_t>(0, window.x - halo), y0 = std::max<std::int64_t>(0, window.y - halo);
  return {x0, y0, std::min(size.width, window.x + window.width + halo) - x0, std::min(size.height, window.y + window.height + halo) - y0};
}

// A window with its voids filled, looking `halo` cells beyond it; the lowest elevation where all around is void. Empty where it has no void.
Raster<float> fill_window(const TreeCells& cells, const Window& window, std::int64_t halo) {
  const Window wide = widen(window, halo, cells.size());
  const Raster<double> stored = read_window(*cells.stored, wide);
  Raster<float> around(wide.width, wide.height);
  for (std::int64_t i = 0; i < around.size().cells(); ++i) around.data()[i] = static_cast<float>(stored.data()[i]);
  const RasterView<float> inside = around.view().sub({window.x - wide.x, window.y - wide.y, window.width, window.height});
  bool any = false;
  for (std::int64_t y = 0; y < window.height && !any; ++y) any = std::any_of(inside.row(y), inside.row(y) + window.width, [](float v) { return std::isnan(v); });
  if (!any) return {};
  if (std::all_of(around.data(), around.data() + around.size().cells(), [](float v) { return std::isnan(v); }))
    return Raster<float>(window.width, window.height, static_cast<float>(cells.range.lowest));
  fill_voids(around.view());
  Raster<float> filled(window.width, window.height);
  for (std::int64_t y = 0; y < window.height; ++y) std::copy_n(inside.row(y), window.width, filled.view().row(y));
  return filled;
}

// --- masks

// A mask of all levels: level 0 as it is found, the others kept.
class MaskLevels {
 public:
  using Finder = std::function<Raster<std::uint8_t>(const Window&)>;
  MaskLevels(const NodeGrid& grid, Finder find, const Scratch& scratch, int threads) : find_(std::move(find)) {
    for (int level = 1; level <= grid.levels(); ++level) {
      CellStore<std::uint8_t> coarse(grid.level_size(level), scratch, scratch.memory_bytes / 16);
      std::vector<Window> windows;
      visit_windows(grid.level_size(level - 1), tile, [&](const Window& window) { windows.push_back(window); });
      std::vector<std::int64_t> counts(windows.size());
      parallel_for(static_cast<std::int64_t>(windows.size()), threads, [&](std::int64_t i) {
        const Window& at = windows[static_cast<std::size_t>(i)];
        const VoidMask fine = read(level - 1, at);
        counts[static_cast<std::size_t>(i)] = std::count(fine.cells.data(), fine.cells.data() + fine.cells.size().cells(), 1);
        coarse.write({at.x / 2, at.y / 2, (at.width + 1) / 2, (at.height + 1) / 2}, coarsen_voids(fine).cells.view());
      });
      if (level == 1) count_ = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
      levels_.push_back(std::move(coarse));
    }
    if (grid.levels() == 0) {
      const Raster<std::uint8_t> all = find_({0, 0, grid.size().width, grid.size().height});
      count_ = std::count(all.data(), all.data() + all.size().cells(), 1);
    }
  }
  /// Cells of level 0 that are 1.
  std::int64_t count() const { return count_; }
  VoidMask read(int level, const Window& window) const {
    return {level > 0 ? levels_[static_cast<std::size_t>(level - 1)].read(window) : find_(window), window.x, window.y};
  }

 private:
  Finder find_;
  std::int64_t count_ = 0;
  std::vector<CellStore<std::uint8_t>> levels_;
};

// What encode_node(node, mask of its level around, mask of its block) gives for each node, and the mask of the coarsest level.
MaskStreams encode_levels(const MaskLevels& levels, const NodeGrid& grid, int threads,
                          const std::function<std::vector<std::byte>(const NodeAddress&, const VoidMask&, const VoidMask&)>& encode_node) {
  MaskStreams masks;
  masks.nodes.resize(static_cast<std::size_t>(grid.node_count()));
  parallel_for(grid.node_count(), threads, [&](std::int64_t i) {
    const NodeAddress node = grid.address(i);
    const Window at = grid.cells(node);
    const Window coarse = widen({at.x / 2, at.y / 2, (at.width + 1) / 2, (at.height + 1) / 2}, 1, grid.level_size(node.level));
    masks.nodes[static_cast<std::size_t>(i)] = encode_node(node, levels.read(node.level, coarse), levels.read(node.level - 1, at));
  });
  const Size root = grid.level_size(grid.levels());
  masks.root = encode_root_voids(levels.read(grid.levels(), {0, 0, root.width, root.height}));
  return masks;
}

}  // namespace

void visit_cells(const StoredSource& source, const std::function<void(const Window&, const Raster<double>&)>& visit) {
  visit_windows(source.size(), tile, [&](const Window& window) { visit(window, read_window(source, window)); });
}

Raster<double> read_level(const StoredSource& source, int level, const Window& window) {
  if (level == 0) return read_window(source, window);
  Raster<double> cells(window.width, window.height), row(((window.width - 1) << level) + 1, 1);
  for (std::int64_t y = 0; y < window.height; ++y) {
    source.read_stored({window.x << level, (window.y + y) << level, row.width(), 1}, row.view());
    for (std::int64_t x = 0; x < window.width; ++x) cells(x, y) = row(x << level, 0);
  }
  return cells;
}

TreeCells read_tree_cells(const StoredSource& source, const TreeHeader& header, const Scratch& scratch, Progress* progress) {
  TreeCells cells;
  cells.stored = hold_cells(source, scratch);
  if (progress) progress->begin("reading", source.size().cells());
  visit_cells(*cells.stored, [&](const Window&, const Raster<double>& part) {
    if (progress) progress->advance(part.size().cells());
    const StoredValues values(part.data(), static_cast<std::size_t>(part.size().cells()));
    cells.range.add(values);
    cells.valid += std::count_if(values.begin(), values.end(), [](double v) { return !std::isnan(v); });
  });
  if (progress) progress->end();
  const std::int64_t all = cells.size().cells();
  cells.any_void = cells.valid < all;
  if (cells.valid == 0) throw Error(ErrorKind::input, "nothing to compress: all " + std::to_string(all) + " cells are void");
  cells.metres_per_stored = std::abs(header.scale) * header.geo.metres_per_unit;
  return cells;
}

FilledCells::FilledCells(const TreeCells& cells, const Scratch& scratch, int threads) : cells_(cells) {
  if (!cells.any_void) return;
  const Size size = cells.size();
  fills_ = CellStore<float>(size, scratch, scratch.memory_bytes / 4);
  const bool one = size.width <= one_fill && size.height <= one_fill;
  std::vector<Window> windows;
  visit_windows(size, one ? one_fill : tile, [&](const Window& window) { windows.push_back(window); });
  parallel_for(static_cast<std::int64_t>(windows.size()), threads, [&](std::int64_t i) {
    const Window& at = windows[static_cast<std::size_t>(i)];
    const Raster<float> filled = fill_window(cells, at, fill_halo);
    if (filled.size().cells() > 0) fills_.write(at, filled.view());
  });
}

void FilledCells::read(const Window& window, RasterView<float> out) const {
  const Raster<double> stored = read_window(*cells_.stored, window);
  const Raster<float> fills = cells_.any_void ? fills_.read(window) : Raster<float>();
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) {
      const double value = stored(x, y);
      out(x, y) = std::isnan(value) ? fills(x, y) : static_cast<float>(value);
    }
}

void MappedCells::read(const Window& window, RasterView<std::int32_t> values, RasterView<std::uint8_t> voids) const {
  const Raster<double> stored = read_window(*cells_.stored, window);
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x) {
      const bool is_void = std::isnan(stored(x, y));
      values(x, y) = is_void ? 0 : map_.number_of(stored(x, y));
      if (voids.data != nullptr) voids(x, y) = is_void;
    }
}

std::size_t MaskStreams::bytes() const {
  return std::accumulate(nodes.begin(), nodes.end(), root.size(), [](std::size_t sum, const std::vector<std::byte>& node) { return sum + node.size(); });
}

MaskStreams encode_masks(const TreeCells& cells, const NodeGrid& grid, const Scratch& scratch, int threads) {
  if (!cells.any_void) return {};
  const auto find = [&](const Window& window) {
    const Raster<double> stored = read_window(*cells.stored, window);
    Raster<std::uint8_t> voids(window.width, window.height);
    for (std::int64_t i = 0; i < stored.size().cells(); ++i) voids.data()[i] = std::isnan(stored.data()[i]);
    return voids;
  };
  return encode_levels(MaskLevels(grid, find, scratch, threads), grid, threads,
                       [&](const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine) { return encode_voids(grid, node, coarse, fine); });
}

MaskStreams encode_flat_water(const TreeCells& cells, ValueType type, const NodeGrid& grid, double least_share, const Scratch& scratch, int threads) {
  const auto find = [&](const Window& window) {
    const Window wide = widen(window, flat_reach, cells.size());
    const Raster<std::uint8_t> around = find_flat_cells(read_window(*cells.stored, wide).view());
    Raster<std::uint8_t> flat(window.width, window.height);
    for (std::int64_t y = 0; y < window.height; ++y)
      std::copy_n(around.view().row(window.y + y - wide.y) + (window.x - wide.x), window.width, flat.view().row(y));
    return flat;
  };
  if (grid.levels() == 0) return {};  // nodes have the values
  const MaskLevels levels(grid, find, scratch, threads);
  if (levels.count() == 0 || static_cast<double>(levels.count()) < least_share * static_cast<double>(cells.valid)) return {};
  return encode_levels(levels, grid, threads, [&](const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine) {
    if (std::none_of(fine.cells.data(), fine.cells.data() + fine.cells.size().cells(), [](std::uint8_t flat) { return flat != 0; }))
      return std::vector<std::byte>();
    return encode_flat(grid, node, coarse, fine, read_level(*cells.stored, node.level - 1, grid.cells(node)).view(), type);
  });
}

}  // namespace arete
