#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace arete {

/// Changes bytes in place, of which there may be up to `most` afterwards; gives how many there are. LLVMFuzzerMutate is one.
using MutateBytes = std::size_t (*)(std::uint8_t* data, std::size_t size, std::size_t most);

/// Changes a tree's file behind its checksums, so that what is changed reaches the decoders: a stream, a mask, the root, the
/// parameters or a field of the header of a file that can be read; else, and now and then, any bytes, with a directory's length and
/// checksum that fit. At most `most` bytes; gives the bytes unsealed where no change of their parts fits.
std::vector<std::byte> mutate_tree(std::span<const std::byte> file, std::size_t most, std::uint32_t seed, MutateBytes mutate);

}  // namespace arete
