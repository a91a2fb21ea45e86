#pragma once

#include <array>
#include <cstdint>

namespace arete {

// Trellis-coded quantisation with eight states (Marcellin & Fischer, 1990; driven by the parity of the index as in
// Schwarz et al., "Quantization and entropy coding in VVC", 2021). A state has one of two quantisers: even multiples of the
// step, or odd multiples and 0. The parity of each index picks the next state. 1.09 dB better than a uniform quantiser at
// high rates.

inline constexpr int trellis_states = 8;
inline constexpr std::array<std::array<std::uint8_t, 2>, trellis_states> trellis_next{
    {{0, 2}, {5, 7}, {1, 3}, {6, 4}, {2, 0}, {4, 6}, {3, 1}, {7, 5}}};

/// 0: even multiples, 1: odd multiples and 0.
inline int quantiser_of(int state) { return state & 1; }

/// The multiple of the step that index k >= 0 stands for.
inline std::int32_t lattice_point(std::int32_t k, int quantiser) { return k == 0 ? 0 : 2 * k - quantiser; }

/// The index of a multiple that the quantiser has.
inline std::int32_t lattice_index(std::int32_t magnitude, int quantiser) { return (magnitude + quantiser) / 2; }

}  // namespace arete
