#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/codec/patch_parameters.h"

namespace arete {

// The discs of a node: their quantised means and coefficients, and the stream of these.

struct DiscTerm {
  std::int32_t atom = 0;
  std::int32_t coefficient = 0;  ///< in quanta, not 0
  bool operator==(const DiscTerm&) const = default;
};

struct DiscBlock {
  PatchRange columns, rows;            ///< of the patch grid
  std::vector<std::int32_t> means;     ///< row by row, in quanta above the base
  std::vector<std::uint32_t> first;    ///< terms [first[i], first[i + 1]) are those of disc i
  std::vector<DiscTerm> terms;         ///< of a disc by atom, ascending
  std::int64_t count() const { return columns.count() * rows.count(); }
  std::int64_t index(std::int64_t column, std::int64_t row) const { return (row - rows.begin) * columns.count() + column - columns.begin; }
  std::span<const DiscTerm> terms_of(std::int64_t i) const {
    const auto at = static_cast<std::size_t>(i);
    return std::span(terms).subspan(first[at], first[at + 1] - first[at]);
  }
};

/// The discs of a node of level 1: those with their centre, moved into the raster, over its cells. A raster without nodes has
/// one block of all discs. Every disc of the patch grid lies in one block.
PatchRange discs_of_node(std::int64_t node, std::int64_t cells, int side, int radius);
/// The block that a disc of the patch grid lies in, along one axis.
std::int64_t node_of_disc(std::int64_t disc, std::int64_t cells, int side, int radius);
/// How many blocks there are.
Size disc_blocks(const NodeGrid& grid);
/// A block without relief: all means 0, no terms.
DiscBlock blank_discs(const PatchParameters& parameters, std::int64_t node_x, std::int64_t node_y);

/// How each atom goes with a slope and a curvature of the means around its disc: what the means lead a coder to expect.
/// [atom][x, y, x^2, y^2, x y]: sums over the disc, all shifted so that they fit 14 bits.
struct AtomMoments {
  std::vector<std::array<std::int32_t, 5>> of;
};
AtomMoments find_moments(const PatchAtoms& atoms);

/// The stream of a block; empty for a block without relief. Each disc has at most parameters.sparsity terms, magnitudes are at
/// most patch_value_limit.
std::vector<std::byte> encode_discs(const PatchParameters& parameters, const AtomMoments& moments, const DiscBlock& block);

/// The inverse; `block` comes from blank_discs. Safe for untrusted bytes: any bytes give some discs within the limits.
/// Memory: up to 8 s bytes a disc.
void decode_discs(const PatchParameters& parameters, const AtomMoments& moments, std::span<const std::byte> bytes, DiscBlock& block);

}  // namespace arete
