#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/codec/exceptions.h"
#include "core/codec/value_map.h"

namespace arete {

// What a map keeps beside the numbers of the predictive coder (ValueMap::beside_of): the second part of a node's stream.

/// Of stored numbers, voids being NaN. Empty where all that the stream has is 0.
std::vector<std::byte> pack_beside(const ValueMap& map, RasterView<const double> stored, StreamCells which);

/// The inverse: sets the cells that the stream has; `cells` has the others already. Safe for untrusted bytes: throws Error{damaged};
/// `name` stands for the file.
void unpack_beside(const ValueMap& map, std::span<const std::byte> bytes, RasterView<std::uint64_t> cells, StreamCells which, const std::string& name);

}  // namespace arete
