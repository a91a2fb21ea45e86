#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/terrain/raster.h"

namespace arete {

// How far stored numbers lie from the quanta that stand for them (ValueMap::Kind::near_steps), counted in floats, modulo 2^64: 0 of
// nearly all cells. A modelled bit a cell says so, in the context of the cells around it that are known; the others are a sign and
// a magnitude. Laid out in core/codec/predictive-format.md.

/// The cells that a stream has numbers of: all, as the root, or those with an odd x or y, as a node, which knows the others already.
enum class StreamCells { all, off_lattice };

constexpr bool has_number(StreamCells which, std::int64_t x, std::int64_t y) { return which == StreamCells::all || x % 2 != 0 || y % 2 != 0; }

/// Empty where all numbers of the stream are 0.
std::vector<std::byte> pack_exceptions(RasterView<const std::uint64_t> cells, StreamCells which);

/// The inverse: sets the cells that the stream has. Any bytes give some numbers.
void unpack_exceptions(std::span<const std::byte> bytes, RasterView<std::uint64_t> cells, StreamCells which);

}  // namespace arete
