#include "core/tree/tree_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/support/error.h"
#include "core/support/parallel.h"
#include "core/terrain/fill_voids.h"

namespace arete {
namespace {

class Original final : public StoredSource {
 public:
  explicit Original(const Raster<double>& stored) : stored_(stored) {}
  Size size() const override { return stored_.size(); }
  void read_stored(const Window& window, RasterView<double> out) const override {
    for (std::int64_t y = 0; y < window.height; ++y) std::copy_n(stored_.view().row(window.y + y) + window.x, window.width, out.row(y));
  }

 private:
  const Raster<double>& stored_;
};

}  // namespace

TreeCells read_tree_cells(const StoredSource& source, const TreeHeader& header) {
  const Size size = source.size();
  TreeCells cells{Raster<double>(size.width, size.height), {Raster<std::uint8_t>(size.width, size.height), 0, 0}};
  source.read_stored({0, 0, size.width, size.height}, cells.stored.view());
  cells.lowest = std::numeric_limits<double>::infinity();
  cells.highest = -cells.lowest;
  for (std::int64_t i = 0; i < size.cells(); ++i) {
    const double value = cells.stored.data()[i];
    cells.voids.cells.data()[i] = std::isnan(value);
    if (std::isnan(value)) continue;
    ++cells.valid;
    cells.lowest = std::min(cells.lowest, value);
    cells.highest = std::max(cells.highest, value);
  }
  cells.any_void = cells.valid < size.cells();
  if (cells.valid == 0) throw Error(ErrorKind::input, "nothing to compress: all " + std::to_string(size.cells()) + " cells are void");
  cells.metres_per_stored = std::abs(header.scale) * header.geo.metres_per_unit;
  return cells;
}

Raster<float> fill_cells(const TreeCells& cells) {
  Raster<float> filled(cells.stored.width(), cells.stored.height());
  for (std::int64_t i = 0; i < filled.size().cells(); ++i) filled.data()[i] = static_cast<float>(cells.stored.data()[i]);
  if (cells.any_void) fill_voids(filled.view());
  return filled;
}

MaskStreams encode_masks(const TreeCells& cells, const NodeGrid& grid, int threads) {
  MaskStreams masks;
  if (!cells.any_void) return masks;
  masks.nodes.resize(static_cast<std::size_t>(grid.node_count()));
  VoidMask fine{cells.voids.cells.clone(), 0, 0};
  for (int level = 1; level <= grid.levels(); ++level) {
    VoidMask coarse = coarsen_voids(fine);
    const Size nodes = grid.nodes(level);
    parallel_for(nodes.cells(), threads, [&](std::int64_t i) {
      const NodeAddress node{level, i % nodes.width, i / nodes.width};
      masks.nodes[static_cast<std::size_t>(grid.index(node))] = encode_voids(grid, node, coarse, fine);
    });
    fine = std::move(coarse);
  }
  masks.root = encode_root_voids(fine);
  return masks;
}

std::vector<std::byte> write_tree(TreeHeader header, const MaskStreams& masks, const std::vector<std::byte>& root,
                                  const std::vector<std::vector<std::byte>>& nodes) {
  std::vector<std::byte> file;
  TreeWriter writer([&](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  header.voids = !masks.root.empty();
  for (std::size_t i = 0; i < nodes.size(); ++i) writer.add_node(header.voids ? join_parts({masks.nodes[i], nodes[i]}) : nodes[i]);
  header.root = header.voids ? join_parts({masks.root, root}) : root;
  writer.finish(header);
  return file;
}

TreeErrors measure_file(const TreeCells& cells, const std::vector<std::byte>& file, int threads) {
  return measure_tree(ElevationTree(TreeFile(view_bytes(file), "the tree just made"), threads), Original(cells.stored));
}

}  // namespace arete
