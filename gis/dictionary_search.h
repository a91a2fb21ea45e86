#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/codec/patch_parameters.h"
#include "core/sparse/dictionary.h"

namespace arete {

// Dictionaries (.atoms) that are named and not given: by a word on the command line, or by the digest in a tree.

/// Where they are looked for, in this order: the folder of the file `beside` (unless empty), the folders in the environment variable
/// ARETE_DICTIONARIES with ':' between, and those that are shipped: share/arete/dictionaries of the installation, or the sources'
/// dictionaries/ where the program runs from its build folder.
std::vector<std::string> dictionary_folders(const std::string& beside = {});

/// The file that a path, or a name with or without its ".atoms", stands for: the path itself where there is such a file, else the first
/// of that name in dictionary_folders(). Throws Error{input}, with the folders, where there is none.
std::string locate_dictionary(const std::string& path_or_name);

struct FoundDictionary {
  std::string path;
  std::uint64_t bytes = 0;  ///< of the file
  Dictionary dictionary;
};

/// The first file in dictionary_folders(beside) whose dictionary has that digest (dictionary_digest), in order of names within a folder.
/// Files that cannot be read are passed over. Costs the reading of the .atoms files before it.
std::optional<FoundDictionary> find_dictionary(const std::string& digest, const std::string& beside);

/// Gives ElevationTree the dictionaries that the tree `beside` names. It throws Error{input} with the digest and the folders where
/// there is none.
DictionaryFinder dictionary_finder(const std::string& beside);

}  // namespace arete
