#include "core/codec/predictive_coder.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/codec/predict_part.h"
#include "core/codec/predict_root.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

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

void copy_cells(RasterView<const std::int32_t> from, RasterView<std::int32_t> to) {
  for (std::int64_t y = 0; y < from.height; ++y) std::copy_n(from.row(y), from.width, to.row(y));
}

}  // namespace

Raster<std::int32_t> decode_predictive(const NodeGrid& grid, const PredictParameters& parameters, std::span<const std::byte> root,
                                       const StreamReader& streams, const VoidReader& voids, int level, const Window& window, int threads,
                                       NumberCache* cache) {
  std::vector<Window> needed{window};
  for (int l = level + 1; l <= grid.levels(); ++l) needed.push_back(needed_above(grid, l, needed.back()));

  const std::int64_t side = grid.side();
  const Size top = grid.level_size(grid.levels());
  LevelPart part;
  part.values = Raster<std::int32_t>(top.width, top.height);
  if (voids) part.voids = voids(grid.levels(), {0, 0, top.width, top.height});
  decode_root(parameters, root, part.mask(), part.values.view());
  for (int l = grid.levels(); l > level; --l) {
    // whole blocks over what is needed
    const Window& w = needed[static_cast<std::size_t>(l - 1 - level)];
    const std::int64_t x0 = w.x / side, y0 = w.y / side;
    const std::int64_t wide = (w.x + w.width + side - 1) / side - x0, high = (w.y + w.height + side - 1) / side - y0;
    const Window last = grid.cells({l, x0 + wide - 1, y0 + high - 1});
    LevelPart finer;
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
      const RasterView<std::int32_t> to = finer.values.view().sub(here);
      std::shared_ptr<const Raster<std::int32_t>> kept;
      if (cache != nullptr && cache->find(grid.index(node), kept)) return copy_cells(kept->view(), to);
      decode_node(coarse, cells, parameters, parameters.levels[static_cast<std::size_t>(l - 1)], streams(grid.index(node)), finer.mask(here), to);
      if (cache == nullptr) return;
      auto block = std::make_shared<Raster<std::int32_t>>(cells.width, cells.height);
      copy_cells(to, block->view());
      cache->keep(grid.index(node), std::move(block), cells.width * cells.height * static_cast<std::int64_t>(sizeof(std::int32_t)));
    });
    part = std::move(finer);
  }
  Raster<std::int32_t> out(window.width, window.height);
  for (std::int64_t y = 0; y < window.height; ++y)
    std::copy_n(part.values.view().row(window.y + y - part.y) + (window.x - part.x), window.width, out.view().row(y));
  return out;
}

}  // namespace arete
