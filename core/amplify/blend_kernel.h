#pragma once

#include <cstdint>

namespace arete {

/// A block of a blended terrain: out(x, y) = base + (start + sum over the terms of factors[t] blocks[t](x, y)), for width x height cells.
/// Each block has `block_stride` floats from row to row. Terms are added in order, whatever the machine's vector length; the base is
/// added last, so that the sum keeps the digits of the small terms (`start` is what the base itself lost to rounding).
void blend_block(const float* const* blocks, const float* factors, std::int64_t terms, std::int64_t block_stride, float base, float start, float* out,
                 std::int64_t out_stride, std::int64_t width, std::int64_t height);

}  // namespace arete
