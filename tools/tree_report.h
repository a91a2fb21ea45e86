#pragma once

#include <string>

#include "core/tree/compress.h"
#include "core/tree/elevation_tree.h"
#include "gis/dictionary_search.h"
#include "tools/info.h"

namespace arete::tools {

/// A tree against the DEM that it was made of.
FileReport describe_errors(const std::string& input, const std::string& output, ValueType type, const TreeErrors& errors);

/// What `arete compress` says of the tree it made.
FileReport describe_compression(const std::string& input, const std::string& output, ValueType type, const CompressionReport& report);

/// Adds what a tree takes together with the dictionary that it names.
void add_dictionary(FileReport& said, const TreeErrors& errors, const std::string& digest, const FoundDictionary& dictionary);

/// A claim in words: "no cell is further off than 1 m".
std::string describe_claim(const TreeHeader& header);

}  // namespace arete::tools
