#pragma once

#include <string>

#include "core/tree/compress.h"
#include "core/tree/elevation_tree.h"
#include "tools/info.h"

namespace arete::tools {

/// A tree against the DEM that it was made of.
FileReport describe_errors(const std::string& input, const std::string& output, ValueType type, const TreeErrors& errors);

/// What `arete compress` says of the tree it made.
FileReport describe_compression(const std::string& input, const std::string& output, ValueType type, const CompressionReport& report);

/// A claim in words: "no cell is further off than 1 m".
std::string describe_claim(const TreeHeader& header);

}  // namespace arete::tools
