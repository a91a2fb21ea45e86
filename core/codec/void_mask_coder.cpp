#include "core/codec/void_mask_coder.h"

#include <algorithm>

#include "core/codec/bit_model.h"
#include "core/codec/byte_stream.h"
#include "core/codec/range_coder.h"

namespace arete {
namespace {

constexpr unsigned adaptation_limit = 250;

// By the parities of x and y (less one), the four coarse cells around, and the cells to the left, above left and above.
struct MaskModels {
  BitModel models[3][16][8];
  MaskModels() {
    for (auto& parity : models)
      for (unsigned coarse = 0; coarse < 16; ++coarse)
        for (BitModel& model : parity[coarse]) {
          // Where all coarse cells agree, the cell between them most often does.
          if (coarse == 0) model.state = (1U << 25) | 8;
          if (coarse == 15) model.state = (127U << 25) | 8;
        }
  }
};

int coarse_at(const VoidMask& mask, const Size& level, std::int64_t x, std::int64_t y) {
  return mask.cells(std::min(x, level.width - 1) - mask.x, std::min(y, level.height - 1) - mask.y);
}

// Visits the cells of the block that are not on the coarse grid, with their contexts: code(model, x, y) gives the bit.
template <class Code>
void visit_cells(const NodeGrid& grid, const NodeAddress& node, const VoidMask& coarse, Raster<std::uint8_t>& block, Code code) {
  const Window at = grid.cells(node);
  const Size level = grid.level_size(node.level);
  MaskModels models;
  for (std::int64_t y = 0; y < at.height; ++y)
    for (std::int64_t x = 0; x < at.width; ++x) {
      const std::int64_t cx = (at.x + x) / 2, cy = (at.y + y) / 2;
      const int parity = static_cast<int>((x & 1) + 2 * (y & 1));
      const int here = coarse_at(coarse, level, cx, cy);
      if (parity == 0) {
        block(x, y) = static_cast<std::uint8_t>(here);
        continue;
      }
      const std::int64_t right = cx + (x & 1), below = cy + (y & 1);
      const int around = here + 2 * coarse_at(coarse, level, right, cy) + 4 * coarse_at(coarse, level, cx, below) + 8 * coarse_at(coarse, level, right, below);
      const int left = x > 0 ? block(x - 1, y) : here;
      const int above = y > 0 ? block(x, y - 1) : here;
      const int corner = x > 0 && y > 0 ? block(x - 1, y - 1) : here;
      BitModel& model = models.models[parity - 1][around][left + 2 * above + 4 * corner];
      block(x, y) = static_cast<std::uint8_t>(code(model, x, y));
    }
}

Probability held(const BitModel& model) { return std::clamp<Probability>(model.p(), 16, 65520); }

}  // namespace

VoidMask coarsen_voids(const VoidMask& fine) {
  VoidMask coarse{Raster<std::uint8_t>((fine.cells.width() + 1) / 2, (fine.cells.height() + 1) / 2), 0, 0};
  for (std::int64_t y = 0; y < coarse.cells.height(); ++y)
    for (std::int64_t x = 0; x < coarse.cells.width(); ++x) coarse.cells(x, y) = fine.cells(2 * x, 2 * y);
  return coarse;
}

std::vector<std::byte> encode_voids(const NodeGrid& grid, const NodeAddress& node, const VoidMask& coarse, const VoidMask& fine) {
  const Window at = grid.cells(node);
  bool any = false;
  for (std::int64_t y = 0; y < at.height && !any; ++y)
    for (std::int64_t x = 0; x < at.width && !any; ++x) any = fine.cells(at.x + x - fine.x, at.y + y - fine.y) != 0;
  if (!any) return {};
  RangeEncoder encoder;
  Raster<std::uint8_t> block(at.width, at.height);
  visit_cells(grid, node, coarse, block, [&](BitModel& model, std::int64_t x, std::int64_t y) {
    const int bit = fine.cells(at.x + x - fine.x, at.y + y - fine.y);
    encoder.encode(bit, held(model));
    model.update(bit, adaptation_limit);
    return bit;
  });
  std::vector<std::byte> bytes = encoder.finish();
  // An empty stream would mean that nothing is void.
  if (bytes.empty()) bytes.push_back(std::byte{0});
  return bytes;
}

void decode_voids(const NodeGrid& grid, const NodeAddress& node, std::span<const std::byte> bytes, const VoidMask& coarse, VoidMask& fine) {
  const Window at = grid.cells(node);
  Raster<std::uint8_t> block(at.width, at.height);
  if (bytes.empty()) {
    std::fill_n(block.data(), block.size().cells(), std::uint8_t{0});
  } else {
    RangeDecoder decoder(bytes);
    visit_cells(grid, node, coarse, block, [&](BitModel& model, std::int64_t, std::int64_t) {
      const int bit = decoder.decode(held(model));
      model.update(bit, adaptation_limit);
      return bit;
    });
  }
  const std::int64_t x0 = std::max(at.x, fine.x), x1 = std::min(at.x + at.width, fine.x + fine.cells.width());
  const std::int64_t y0 = std::max(at.y, fine.y), y1 = std::min(at.y + at.height, fine.y + fine.cells.height());
  for (std::int64_t y = y0; y < y1; ++y)
    for (std::int64_t x = x0; x < x1; ++x) fine.cells(x - fine.x, y - fine.y) = block(x - at.x, y - at.y);
}

std::vector<std::byte> encode_root_voids(const VoidMask& root) {
  const std::int64_t cells = root.cells.size().cells();
  std::vector<std::byte> bytes(static_cast<std::size_t>((cells + 7) / 8));
  for (std::int64_t i = 0; i < cells; ++i)
    if (root.cells.data()[i]) bytes[static_cast<std::size_t>(i / 8)] |= static_cast<std::byte>(1 << (i % 8));
  return bytes;
}

VoidMask decode_root_voids(std::span<const std::byte> bytes, const Size& size, const std::string& name) {
  if (static_cast<std::int64_t>(bytes.size()) != (size.cells() + 7) / 8) ByteReader({}, name).fail("its coarsest mask has another length than its size needs");
  VoidMask root{Raster<std::uint8_t>(size.width, size.height), 0, 0};
  for (std::int64_t i = 0; i < size.cells(); ++i)
    root.cells.data()[i] = std::to_integer<std::uint8_t>(bytes[static_cast<std::size_t>(i / 8)] >> (i % 8)) & 1U;
  return root;
}

}  // namespace arete
