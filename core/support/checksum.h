#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace arete {

/// XXH3 with 64 bits: integrity of our own files, not security.
std::uint64_t checksum64(const void* data, std::size_t bytes);

/// CRC-32 of ISO 3309, as zlib and PNG have it: notices every change within 32 bits in a row.
std::uint32_t crc32_of(std::span<const std::byte> bytes);

/// XXH3 with 128 bits in 32 hexadecimal digits: names a dictionary in metadata.
std::string digest_hex(const void* data, std::size_t bytes);

}  // namespace arete
