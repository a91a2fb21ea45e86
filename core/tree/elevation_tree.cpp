#include "core/tree/elevation_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/codec/byte_stream.h"
#include "core/codec/patch_coder.h"
#include "core/codec/void_mask_coder.h"
#include "core/support/error.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

// A node's stream without the mask.
std::vector<std::byte> cells_of(const TreeFile& file, std::int64_t index) {
  std::vector<std::byte> stream = file.read_node(index);
  return file.header().voids ? split_parts(stream, file.name()).cells : stream;
}

// The root of a tree with voids: the coarsest mask, then the coder's.
NodeParts root_parts(const TreeFile& file) {
  if (!file.header().voids) return {{}, file.header().root};
  return split_parts(file.header().root, file.name());
}

// The part of level l + 1 that masks of a window of level l depend on.
Window coarse_window(const Window& fine, const Size& coarse) {
  const std::int64_t x0 = fine.x / 2, y0 = fine.y / 2;
  const std::int64_t x1 = std::min(coarse.width, (fine.x + fine.width) / 2 + 2), y1 = std::min(coarse.height, (fine.y + fine.height) / 2 + 2);
  return {x0, y0, x1 - x0, y1 - y0};
}

// A window grown to whole blocks of nodes of the level above it.
Window whole_blocks(const NodeGrid& grid, int level, const Window& window) {
  const Size size = grid.level_size(level);
  const std::int64_t side = grid.side();
  const std::int64_t x0 = window.x / side * side, y0 = window.y / side * side;
  const std::int64_t x1 = std::min(size.width, (window.x + window.width + side - 1) / side * side);
  const std::int64_t y1 = std::min(size.height, (window.y + window.height + side - 1) / side * side);
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace

ElevationTree::ElevationTree(TreeFile file, int threads) : file_(std::move(file)), threads_(threads) {
  const TreeHeader& about = header();
  switch (about.coder) {
    case TreeCoder::wavelet:
      wavelet_ = decode_wavelet_parameters(about.parameters, about.grid, file_.name());
      break;
    case TreeCoder::predictive: {
      ByteReader in(about.parameters, file_.name());
      map_ = get_value_map(in, about.type);
      predictive_ = decode_parameters(std::span(about.parameters).last(in.left()), about.grid.levels(), file_.name());
      break;
    }
    case TreeCoder::patches:
      patches_ = parse_patch_parameters(about.parameters, file_.name(), about.grid, [this](const std::string& digest) -> Eigen::MatrixXf {
        throw Error(ErrorKind::input, "'" + file_.name() + "' needs the dictionary " + digest + ", which is not here");
      });
      break;
  }
}

ElevationTree ElevationTree::open(const std::string& path, int threads) { return ElevationTree(TreeFile(open_bytes(path), path), threads); }

Raster<double> ElevationTree::decode(int level, const Window& window) const {
  const auto streams = [this](std::int64_t index) { return cells_of(file_, index); };
  Raster<double> stored(window.width, window.height);
  if (header().coder == TreeCoder::predictive) {
    const VoidReader voids = header().voids ? VoidReader([this](int l, const Window& w) { return decode_mask(l, w); }) : VoidReader();
    const Raster<std::int32_t> numbers = decode_predictive(header().grid, predictive_, root_parts(file_).cells, streams, voids, level, window, threads_);
    for (std::int64_t i = 0; i < numbers.size().cells(); ++i) stored.data()[i] = map_.value_of(numbers.data()[i]);
    return stored;
  }
  const Raster<float> cells = header().coder == TreeCoder::patches
                                  ? decode_patches(patches_, root_parts(file_).cells, streams, level, window, threads_)
                                  : decode_wavelet(wavelet_, root_parts(file_).cells, streams, level, window, threads_);
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) stored.data()[i] = static_cast<double>(cells.data()[i]);
  return stored;
}

Raster<std::uint8_t> ElevationTree::decode_mask(int level, const Window& window) const {
  const NodeGrid& grid = header().grid;
  std::vector<Window> windows{window};
  for (int l = level + 1; l <= grid.levels(); ++l) {
    windows.back() = whole_blocks(grid, l - 1, windows.back());
    windows.push_back(coarse_window(windows.back(), grid.level_size(l)));
  }
  VoidMask mask = decode_root_voids(root_parts(file_).voids, grid.level_size(grid.levels()), file_.name());
  for (int l = grid.levels(); l > level; --l) {
    const Window& at = windows[static_cast<std::size_t>(l - 1 - level)];
    VoidMask fine{Raster<std::uint8_t>(at.width, at.height), at.x, at.y};
    const std::int64_t side = grid.side(), x0 = at.x / side, y0 = at.y / side;
    const std::int64_t wide = (at.x + at.width + side - 1) / side - x0, high = (at.y + at.height + side - 1) / side - y0;
    parallel_for(wide * high, threads_, [&](std::int64_t i) {
      const NodeAddress node{l, x0 + i % wide, y0 + i / wide};
      decode_voids(grid, node, split_parts(file_.read_node(grid.index(node)), file_.name()).voids, mask, fine);
    });
    mask = std::move(fine);
  }
  Raster<std::uint8_t> cells(window.width, window.height);
  for (std::int64_t y = 0; y < window.height; ++y)
    std::copy_n(mask.cells.view().row(window.y + y - mask.y) + (window.x - mask.x), window.width, cells.view().row(y));
  return cells;
}

void ElevationTree::read_stored(int level, const Window& window, RasterView<double> out) const {
  const Raster<double> cells = decode(level, window);
  const Raster<std::uint8_t> mask = header().voids ? decode_mask(level, window) : Raster<std::uint8_t>();
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      out(x, y) = header().voids && mask(x, y) ? std::numeric_limits<double>::quiet_NaN() : hold_to(header().type, cells(x, y));
}

void ElevationTree::read_level(int level, const Window& window, RasterView<float> out) const {
  const Raster<double> cells = decode(level, window);
  const Raster<std::uint8_t> mask = header().voids ? decode_mask(level, window) : Raster<std::uint8_t>();
  const double metres = header().geo.metres_per_unit;
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      out(x, y) = header().voids && mask(x, y) ? void_value : static_cast<float>((header().scale * cells(x, y) + header().offset) * metres);
}

void ElevationTree::verify_checksums() const {
  parallel_for(static_cast<std::int64_t>(file_.nodes().size()), threads_, [this](std::int64_t i) { file_.read_node(i); });
}

std::vector<Window> split_window(const Window& window, std::int64_t memory_bytes) {
  constexpr std::int64_t block = NodeGrid::greatest_side, bytes_per_cell = 64;
  const std::int64_t blocks = std::max<std::int64_t>(1, memory_bytes / bytes_per_cell / (block * block));
  const std::int64_t across = (window.width + block - 1) / block;
  const std::int64_t wide = std::min(across, blocks) * block, high = std::max<std::int64_t>(1, blocks / across) * block;
  std::vector<Window> parts;
  for (std::int64_t y = 0; y < window.height; y += high)
    for (std::int64_t x = 0; x < window.width; x += wide)
      parts.push_back({window.x + x, window.y + y, std::min(wide, window.width - x), std::min(high, window.height - y)});
  return parts;
}

}  // namespace arete
