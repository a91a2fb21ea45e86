#pragma once

#include <string>
#include <string_view>

namespace arete {

/// A zlib stream (RFC 1950) of the bytes, which browsers call 'deflate'; as small as zlib makes it. The same bytes, the same stream.
/// Throws Error{memory}.
std::string deflate_bytes(std::string_view bytes);

}  // namespace arete
