#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/codec/patch_parameters.h"

namespace arete {

/// The atoms as bytes, without loss: the zero bits that all samples of an atom end with are stored once, the rest as differences
/// to what the samples around predict. Never shorter than least_atom_bytes.
std::vector<std::byte> encode_atoms(const PatchAtoms& atoms);

/// The inverse: `count` atoms of side x side samples. Safe for untrusted bytes: any bytes give some atoms. The caller holds `bytes` against
/// least_atom_bytes before.
PatchAtoms decode_atoms(std::span<const std::byte> bytes, int side, std::int64_t count);

/// The least length of the stream, which bounds the memory that a short file can ask for: 1 byte for each atom and each 256 samples.
std::int64_t least_atom_bytes(int side, std::int64_t count);

}  // namespace arete
