#pragma once

#include <cstdint>

namespace arete {

/// Sums of one row of coarse cells: out[p * stride + x] = sum over taps (dy, dx) of weights[p T + tap] *
/// ((z[dy][x + dx] - z[reach][x + reach]) - (e[dy][x + dx] - e[reach][x + reach])), for x in [0, count), p in [0, phases).
/// z (and e, or null) are 2 reach + 1 row pointers, each readable for count + 2 reach + 16 floats; `stride` is count rounded up to 16 or more.
/// Sums run in the order of the taps, whatever the machine's vector length.
void sum_taps(const float* const* z, const float* const* e, int reach, const float* weights, int phases, std::int64_t count, float* out,
              std::int64_t stride);

/// One row of fine cells from the sums of its `factor` phases (each `stride` floats apart): out[x f + p] = z[x] + (sum_p[x] +
/// (out[x f + p] - e[x])), or z[x] + sum_p[x] where e is null and `out` is overwritten.
void place_phases(const float* z, const float* e, const float* sums, std::int64_t stride, int factor, std::int64_t count, float* out);

}  // namespace arete
