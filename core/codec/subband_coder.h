#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/codec/bit_model.h"
#include "core/terrain/raster.h"

namespace arete {

// The entropy coder of quantised wavelet coefficients: three detail bands of a node, band by band, row by row. Each decision
// (zero or not, sign, larger than 1, than 2, ...) is predicted in two contexts made of the magnitudes around it, and the
// predictions are mixed. Contexts look at what the decoder has already: the same band above and to the left, the bands of
// the node coded before, the same band of the parent node. Laid out to the bit in core/codec/tree-format.md.

/// Detail bands of a level: high-pass along x, along y, along both. Coded in this order.
enum class Band : int { horizontal = 0, vertical = 1, diagonal = 2 };
inline constexpr int band_count = 3;

/// The quantised coefficients of a block of one band, with a border of zeros so that contexts need no border cases.
/// Values are lattice points: an elevation detail is about value x step / gain of the band.
class CoefficientBlock {
 public:
  static constexpr int border = 2;
  CoefficientBlock() = default;
  CoefficientBlock(int width, int height)
      : width_(width), height_(height), cells_(static_cast<std::size_t>(stride()) * static_cast<std::size_t>(height + 2 * border)),
        magnitudes_(cells_.size()),
        flags_(static_cast<std::size_t>(squares_wide()) * static_cast<std::size_t>(squares_high())) {}
  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return width_ + 2 * border; }
  /// Squares of block_size x block_size coefficients, row by row: whether the square is coded; the others are zero.
  static constexpr int square = 8;
  int squares_wide() const { return (width_ + square - 1) / square; }
  int squares_high() const { return (height_ + square - 1) / square; }
  std::uint8_t* flags(int square_row) { return flags_.data() + static_cast<std::ptrdiff_t>(square_row) * squares_wide(); }
  const std::uint8_t* flags(int square_row) const { return flags_.data() + static_cast<std::ptrdiff_t>(square_row) * squares_wide(); }
  /// Row y from -border to height + border - 1; columns from -border on may be read.
  const std::int32_t* row(int y) const { return cells_.data() + offset(y); }
  /// To change values of a row; hold_magnitudes must follow for the columns [first, end) that were.
  std::int32_t* row(int y) { return cells_.data() + offset(y); }
  void hold_magnitudes(int y, int first, int end) {
    const std::int32_t* from = row(y);
    std::uint8_t* to = magnitudes_.data() + offset(y);
    for (int x = first; x < end; ++x) {
      const std::int32_t magnitude = from[x] < 0 ? -from[x] : from[x];
      to[x] = static_cast<std::uint8_t>(magnitude < 255 ? magnitude : 255);
    }
  }
  /// The magnitudes of a row, held to 255: all that contexts need.
  const std::uint8_t* magnitudes(int y) const { return magnitudes_.data() + offset(y); }
  void set(int x, int y, std::int32_t value) {
    cells_[static_cast<std::size_t>(offset(y) + x)] = value;
    const std::int32_t magnitude = value < 0 ? -value : value;
    magnitudes_[static_cast<std::size_t>(offset(y) + x)] = static_cast<std::uint8_t>(magnitude < 255 ? magnitude : 255);
  }

 private:
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t offset(int y) const { return static_cast<std::ptrdiff_t>(y + border) * stride() + border; }
  std::vector<std::int32_t> cells_;
  std::vector<std::uint8_t> magnitudes_;
  std::vector<std::uint8_t> flags_;
};

/// The largest magnitude that may be encoded; a decoder gives at most eight times as much.
inline constexpr std::int32_t coefficient_limit = 1 << 26;

/// The three bands of a node; blocks may be empty where the raster ends.
struct NodeCoefficients {
  std::array<CoefficientBlock, band_count> bands;
};

/// The quarter of a parent node that lies over a node: coefficient (x, y) of the node has its parent at
/// (origin_x + x / 2, origin_y + y / 2).
struct ParentView {
  const NodeCoefficients* node = nullptr;  ///< none at the coarsest level
  int origin_x = 0;
  int origin_y = 0;
};

/// All adaptive probabilities and weights of a node's stream.
struct SubbandModels;
/// Models as every stream starts with them: trained on real terrain (core/codec/subband_states.cpp).
const SubbandModels& initial_subband_models();

/// The stream of a node. |coefficients| <= coefficient_limit, each one that the trellis allows where it stands, and zero
/// where the flag of its square is 0. `models` starts as initial_subband_models() and adapts.
std::vector<std::byte> encode_subbands(const NodeCoefficients& node, const ParentView& parent, SubbandModels& models);

/// The inverse; the blocks of `node` have their sizes already and are zero. Safe for untrusted bytes: any bytes give some
/// coefficients. `models` starts as initial_subband_models() and adapts.
void decode_subbands(std::span<const std::byte> bytes, const ParentView& parent, SubbandModels& models, NodeCoefficients& node);

}  // namespace arete
