#pragma once

#include <string>
#include <string_view>

namespace arete {

/// Text as it stands in HTML, between tags or in an attribute with double quotes.
std::string escape_html(std::string_view text);

/// Base64 (RFC 4648) of bytes.
std::string base64(std::string_view bytes);

}  // namespace arete
