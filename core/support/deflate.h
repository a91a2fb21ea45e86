#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace arete {

/// Bytes in the zlib format (RFC 1950), at its best. The same bytes for the same version of zlib.
std::vector<std::byte> deflate_bytes(std::span<const std::byte> bytes);

/// The inverse. Throws Error{damaged} where the bytes are no such stream, end early, go on after its end, or hold more than
/// `limit` bytes; `name` stands for the file in the message. Allocates in proportion to what comes out.
std::vector<std::byte> inflate_bytes(std::span<const std::byte> bytes, std::size_t limit, const std::string& name);

}  // namespace arete
