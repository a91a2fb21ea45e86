#include "core/tree/elevation_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/codec/byte_stream.h"
#include "core/codec/beside_numbers.h"
#include "core/codec/flat_coder.h"
#include "core/codec/patch_coder.h"
#include "core/codec/stream_parts.h"
#include "core/codec/void_mask_coder.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr std::int64_t kept_bytes = std::int64_t{32} << 20;  // of decoded nodes

// A node's stream without the mask.
std::vector<std::byte> cells_of(const TreeFile& file, std::int64_t index) {
  std::vector<std::byte> stream = file.read_node(index);
  return file.header().voids ? split_parts(stream, file.name()).rest : stream;
}

// The root of a tree: its coarsest mask, empty without voids, and what the coder has.
StreamParts root_parts(const TreeFile& file) {
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

// What has to be decoded of each level, from `level` to the one below the root: whole blocks.
std::vector<Window> block_windows(const NodeGrid& grid, int level, const Window& window) {
  std::vector<Window> windows{window};
  for (int l = level + 1; l <= grid.levels(); ++l) {
    windows.back() = whole_blocks(grid, l - 1, windows.back());
    windows.push_back(coarse_window(windows.back(), grid.level_size(l)));
  }
  return windows;
}

// Goes down from all of the coarsest level to a window of `level`, by parts of levels: cells from column x, row y on, as VoidMask is one.
// refine(node, coarse, fine) fills the cells of the node's block that lie in `fine`; `coarse` has what the block needs of the node's level.
template <class Part, class Refine>
Part refine_levels(const NodeGrid& grid, Part coarse, int level, const Window& window, int threads, const Refine& refine) {
  const std::vector<Window> windows = block_windows(grid, level, window);
  for (int l = grid.levels(); l > level; --l) {
    const Window& at = l == level + 1 ? window : windows[static_cast<std::size_t>(l - 1 - level)];
    Part fine{{at.width, at.height}, at.x, at.y};
    const std::int64_t side = grid.side(), x0 = at.x / side, y0 = at.y / side;
    const std::int64_t wide = (at.x + at.width + side - 1) / side - x0, high = (at.y + at.height + side - 1) / side - y0;
    parallel_for(wide * high, threads, [&](std::int64_t i) { refine(NodeAddress{l, x0 + i % wide, y0 + i / wide}, coarse, fine); });
    coarse = std::move(fine);
  }
  return coarse;
}

// The part of a part that a window asks for: all of it but where the window is of the coarsest level.
template <class T>
Raster<T> crop_to(const Raster<T>& cells, std::int64_t x, std::int64_t y, const Window& window) {
  Raster<T> part(window.width, window.height);
  for (std::int64_t row = 0; row < window.height; ++row)
    std::copy_n(cells.view().row(window.y + row - y) + (window.x - x), window.width, part.view().row(row));
  return part;
}

// What a map keeps beside numbers.
struct BesidePart {
  Raster<std::uint64_t> cells;
  std::int64_t x = 0;
  std::int64_t y = 0;
};

}  // namespace

ElevationTree::ElevationTree(TreeFile file, int threads, const DictionaryFinder& find) : file_(std::move(file)), threads_(threads) {
  const TreeHeader& about = header();
  switch (about.coder) {
    case TreeCoder::wavelet:
      coefficients_ = std::make_unique<CoefficientCache>(kept_bytes);
      wavelet_ = decode_wavelet_parameters(about.parameters, about.grid, file_.name());
      break;
    case TreeCoder::predictive: {
      numbers_ = std::make_unique<NumberCache>(kept_bytes);
      ByteReader in(about.parameters, file_.name());
      map_ = get_value_map(in, about.type);
      predictive_ = decode_parameters(std::span(about.parameters).last(in.left()), about.grid.levels(), file_.name());
      break;
    }
    case TreeCoder::patches:
      patches_ = parse_patch_parameters(about.parameters, file_.name(), about.grid, find);
      break;
  }
}

ElevationTree ElevationTree::open(const std::string& path, int threads, const DictionaryFinder& find) {
  return ElevationTree(TreeFile(open_bytes(path), path), threads, find);
}

Raster<double> ElevationTree::decode_numbers(int level, const Window& window) const {
  const bool has_beside = map_.has_beside();
  const auto numbers_of = [&](std::vector<std::byte> stream) { return has_beside ? split_parts(stream, file_.name()).first : stream; };
  const auto streams = [&](std::int64_t index) { return numbers_of(cells_of(file_, index)); };
  const VoidReader voids = header().voids ? VoidReader([this](int l, const Window& w) { return decode_mask(l, w); }) : VoidReader();
  const Raster<std::int32_t> numbers = decode_predictive(header().grid, predictive_, numbers_of(root_parts(file_).rest), streams, voids, level, window, threads_, numbers_.get());
  const Raster<std::uint64_t> beside = has_beside ? decode_beside(level, window) : Raster<std::uint64_t>();
  Raster<double> stored(window.width, window.height);
  for (std::int64_t i = 0; i < numbers.size().cells(); ++i) stored.data()[i] = map_.value_of(numbers.data()[i], has_beside ? beside.data()[i] : 0);
  return stored;
}

Raster<float> ElevationTree::decode_surface(int level, const Window& window) const {
  const auto coded = [&](std::vector<std::byte> stream) { return has_flat_water() ? split_parts(stream, file_.name()).rest : stream; };
  const auto streams = [&](std::int64_t index) { return coded(cells_of(file_, index)); };
  const std::vector<std::byte> root = coded(root_parts(file_).rest);
  if (header().coder == TreeCoder::patches) return decode_patches(patches_, root, streams, level, window, threads_);
  return decode_wavelet(wavelet_, root, streams, level, window, threads_, coefficients_.get());
}

Raster<double> ElevationTree::decode(int level, const Window& window) const {
  if (header().coder == TreeCoder::predictive) return decode_numbers(level, window);
  const Raster<float> cells = decode_surface(level, window);
  Raster<double> stored(window.width, window.height);
  std::copy_n(cells.data(), cells.size().cells(), stored.data());
  if (has_flat_water()) set_flat_water(level, window, stored);
  return stored;
}

void ElevationTree::set_flat_water(int level, const Window& window, Raster<double>& cells) const {
  const NodeGrid& grid = header().grid;
  VoidMask root = decode_root_voids(split_parts(root_parts(file_).rest, file_.name()).first, grid.level_size(grid.levels()), file_.name());
  refine_levels(grid, std::move(root), level, window, threads_, [&](const NodeAddress& node, const VoidMask& coarse, VoidMask& fine) {
    const RasterView<double> to = node.level == level + 1 ? cells.view() : RasterView<double>{};
    decode_flat(grid, node, split_parts(cells_of(file_, grid.index(node)), file_.name()).first, coarse, fine, to, header().type, file_.name());
  });
}

Raster<std::uint64_t> ElevationTree::decode_beside(int level, const Window& window) const {
  const NodeGrid& grid = header().grid;
  const auto unpack = [&](const std::vector<std::byte>& stream, RasterView<std::uint64_t> cells, StreamCells which) {
    unpack_beside(map_, split_parts(stream, file_.name()).rest, cells, which, file_.name());
  };
  const Size size = grid.level_size(grid.levels());
  BesidePart root{{size.width, size.height}, 0, 0};
  unpack(root_parts(file_).rest, root.cells.view(), StreamCells::all);
  const auto refine = [&](const NodeAddress& node, const BesidePart& coarse, BesidePart& fine) {
    const Window at = grid.cells(node);
    Raster<std::uint64_t> block(at.width, at.height);
    for (std::int64_t y = 0; y < at.height; y += 2)
      for (std::int64_t x = 0; x < at.width; x += 2) block(x, y) = coarse.cells((at.x + x) / 2 - coarse.x, (at.y + y) / 2 - coarse.y);
    unpack(cells_of(file_, grid.index(node)), block.view(), StreamCells::off_lattice);
    const std::int64_t x0 = std::max(at.x, fine.x), x1 = std::min(at.x + at.width, fine.x + fine.cells.width());
    const std::int64_t y0 = std::max(at.y, fine.y), y1 = std::min(at.y + at.height, fine.y + fine.cells.height());
    for (std::int64_t y = y0; y < y1; ++y) std::copy_n(block.view().row(y - at.y) + (x0 - at.x), x1 - x0, fine.cells.view().row(y - fine.y) + (x0 - fine.x));
  };
  const BesidePart part = refine_levels(grid, std::move(root), level, window, threads_, refine);
  return crop_to(part.cells, part.x, part.y, window);
}

Raster<std::uint8_t> ElevationTree::decode_mask(int level, const Window& window) const {
  const NodeGrid& grid = header().grid;
  VoidMask root = decode_root_voids(root_parts(file_).first, grid.level_size(grid.levels()), file_.name());
  const auto refine = [&](const NodeAddress& node, const VoidMask& coarse, VoidMask& fine) {
    decode_voids(grid, node, split_parts(file_.read_node(grid.index(node)), file_.name()).first, coarse, fine);
  };
  const VoidMask mask = refine_levels(grid, std::move(root), level, window, threads_, refine);
  return crop_to(mask.cells, mask.x, mask.y, window);
}

void ElevationTree::read_stored(int level, const Window& window, RasterView<double> out) const {
  const Raster<double> cells = decode(level, window);
  const Raster<std::uint8_t> mask = header().voids ? decode_mask(level, window) : Raster<std::uint8_t>();
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      out(x, y) = header().voids && mask(x, y) ? std::numeric_limits<double>::quiet_NaN() : hold_to(header().type, cells(x, y));
}

template <class T>
void ElevationTree::write_metres(const Raster<T>& stored, RasterView<float> out) const {
  const TreeHeader& about = header();
  const double scale = about.scale, offset = about.offset, metres = about.geo.metres_per_unit;
  for (std::int64_t y = 0; y < out.height; ++y) {
    const T* from = stored.view().row(y);
    float* to = out.row(y);
    if (scale == 1 && offset == 0 && metres == 1)
      for (std::int64_t x = 0; x < out.width; ++x) to[x] = static_cast<float>(from[x]);
    else
      for (std::int64_t x = 0; x < out.width; ++x) to[x] = static_cast<float>((scale * static_cast<double>(from[x]) + offset) * metres);
  }
}

void ElevationTree::read_level(int level, const Window& window, RasterView<float> out) const {
  if (header().coder == TreeCoder::predictive || has_flat_water()) write_metres(decode(level, window), out);
  else write_metres(decode_surface(level, window), out);
  if (!header().voids) return;
  const Raster<std::uint8_t> mask = decode_mask(level, window);
  for (std::int64_t y = 0; y < window.height; ++y)
    for (std::int64_t x = 0; x < window.width; ++x)
      if (mask(x, y) != 0) out(x, y) = void_value;
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
