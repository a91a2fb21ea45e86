#include "core/tree/tree_cells.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/codec/void_mask_coder.h"
#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/fill_voids.h"

namespace arete {
namespace {

constexpr std::int64_t tile = 1024;        // cells along a side, of the parts that rasters are gone through by
constexpr std::int64_t one_fill = 2048;    // rasters up to this are filled in one
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

// What stands in a window where voids are filled; `nothing` where all around is void. Empty where none of the window is.
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

VoidMask read_mask(const TreeCells& cells, const std::vector<CellStore<std::uint8_t>>& levels, int level, const Window& window) {
  if (level > 0) return {levels[static_cast<std::size_t>(level - 1)].read(window), window.x, window.y};
  const Raster<double> stored = read_window(*cells.stored, window);
  VoidMask mask{Raster<std::uint8_t>(window.width, window.height), window.x, window.y};
  for (std::int64_t i = 0; i < stored.size().cells(); ++i) mask.cells.data()[i] = std::isnan(stored.data()[i]);
  return mask;
}

std::vector<CellStore<std::uint8_t>> make_mask_levels(const TreeCells& cells, const NodeGrid& grid, const Scratch& scratch, int threads) {
  std::vector<CellStore<std::uint8_t>> levels;
  for (int level = 1; level <= grid.levels(); ++level) {
    const Size fine = grid.level_size(level - 1);
    CellStore<std::uint8_t> coarse(grid.level_size(level), scratch, scratch.memory_bytes / 16);
    std::vector<Window> windows;
    visit_windows(fine, tile, [&](const Window& window) { windows.push_back(window); });
    parallel_for(static_cast<std::int64_t>(windows.size()), threads, [&](std::int64_t i) {
      const Window& at = windows[static_cast<std::size_t>(i)];
      coarse.write({at.x / 2, at.y / 2, (at.width + 1) / 2, (at.height + 1) / 2}, coarsen_voids(read_mask(cells, levels, level - 1, at)).cells.view());
    });
    levels.push_back(std::move(coarse));
  }
  return levels;
}

}  // namespace

void visit_cells(const StoredSource& source, const std::function<void(const Window&, const Raster<double>&)>& visit) {
  visit_windows(source.size(), tile, [&](const Window& window) { visit(window, read_window(source, window)); });
}

TreeCells read_tree_cells(const StoredSource& source, const TreeHeader& header, const Scratch& scratch) {
  TreeCells cells;
  cells.stored = hold_cells(source, scratch);
  visit_cells(*cells.stored, [&](const Window&, const Raster<double>& part) {
    const StoredValues values(part.data(), static_cast<std::size_t>(part.size().cells()));
    cells.range.add(values);
    cells.valid += std::count_if(values.begin(), values.end(), [](double v) { return !std::isnan(v); });
  });
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

MaskStreams encode_masks(const TreeCells& cells, const NodeGrid& grid, const Scratch& scratch, int threads) {
  MaskStreams masks;
  if (!cells.any_void) return masks;
  const std::vector<CellStore<std::uint8_t>> levels = make_mask_levels(cells, grid, scratch, threads);
  masks.nodes.resize(static_cast<std::size_t>(grid.node_count()));
  parallel_for(grid.node_count(), threads, [&](std::int64_t i) {
    const NodeAddress node = grid.address(i);
    const Window at = grid.cells(node);
    const Window coarse = widen({at.x / 2, at.y / 2, (at.width + 1) / 2, (at.height + 1) / 2}, 1, grid.level_size(node.level));
    masks.nodes[static_cast<std::size_t>(i)] = encode_voids(grid, node, read_mask(cells, levels, node.level, coarse), read_mask(cells, levels, node.level - 1, at));
  });
  const Size root = grid.level_size(grid.levels());
  masks.root = encode_root_voids(read_mask(cells, levels, grid.levels(), {0, 0, root.width, root.height}));
  return masks;
}

}  // namespace arete
