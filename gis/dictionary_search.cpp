#include "gis/dictionary_search.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "core/sparse/dictionary_file.h"
#include "core/support/checksum.h"
#include "core/support/error.h"
#include "core/support/file.h"

namespace arete {
namespace {

namespace fs = std::filesystem;

constexpr const char* folders_variable = "ARETE_DICTIONARIES";

// A program in bin/ has share/ beside its folder; one in build/<preset>/<part>/ has the sources three folders up. Other programs, which
// load the library, find what was installed with it.
std::vector<std::string> shipped_folders() {
  std::vector<std::string> folders;
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (const fs::path& folder : {program / "../share/arete/dictionaries", program / "../../../dictionaries", fs::path(ARETE_INSTALLED_DICTIONARIES)}) {
    const fs::path at = fs::weakly_canonical(folder, none);
    if (!none && fs::is_directory(at, none) && std::find(folders.begin(), folders.end(), at.string()) == folders.end()) folders.push_back(at.string());
  }
  return folders;
}

std::string listed(const std::vector<std::string>& folders) {
  std::string text;
  for (const std::string& folder : folders) text += (text.empty() ? "'" : ", '") + folder + "'";
  return text.empty() ? "any folder, for ARETE_DICTIONARIES names none" : text;
}

std::vector<std::string> dictionaries_in(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none))
    if (at->path().extension() == ".atoms") paths.push_back(at->path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::optional<FoundDictionary> read_if_it_is(const std::string& digest, const std::string& path) {
  try {
    if (!is_dictionary_file(path)) return std::nullopt;
    const std::vector<std::byte> bytes = read_file(path);
    Dictionary dictionary = decode_dictionary(bytes, path);
    // The digest is that of the file, unless it was written with exact atoms.
    if (digest_hex(bytes.data(), bytes.size()) != digest && dictionary_digest(dictionary) != digest) return std::nullopt;
    return FoundDictionary{path, bytes.size(), std::move(dictionary)};
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::string> dictionary_folders(const std::string& beside) {
  std::vector<std::string> folders;
  if (!beside.empty()) folders.push_back(fs::path(beside).has_parent_path() ? fs::path(beside).parent_path().string() : ".");
  const char* set = std::getenv(folders_variable);
  std::istringstream all(set != nullptr ? set : "");
  for (std::string folder; std::getline(all, folder, ':');)
    if (!folder.empty()) folders.push_back(folder);
  for (std::string& folder : shipped_folders()) folders.push_back(std::move(folder));
  return folders;
}

std::string locate_dictionary(const std::string& path_or_name) {
  std::error_code none;
  if (fs::exists(path_or_name, none)) return path_or_name;
  const std::vector<std::string> folders = dictionary_folders();
  if (!fs::path(path_or_name).has_parent_path())
    for (const std::string& folder : folders)
      for (const char* ending : {"", ".atoms"})
        if (const fs::path path = fs::path(folder) / (path_or_name + ending); fs::is_regular_file(path, none)) return path.string();
  throw Error(ErrorKind::input, "no dictionary '" + path_or_name + "': there is no such file, nor one of that name in " + listed(folders));
}

std::optional<FoundDictionary> find_dictionary(const std::string& digest, const std::string& beside) {
  for (const std::string& folder : dictionary_folders(beside))
    for (const std::string& path : dictionaries_in(folder))
      if (std::optional<FoundDictionary> found = read_if_it_is(digest, path)) return found;
  return std::nullopt;
}

DictionaryFinder dictionary_finder(const std::string& beside) {
  return [beside](const std::string& digest) -> Eigen::MatrixXf {
    if (std::optional<FoundDictionary> found = find_dictionary(digest, beside)) return std::move(found->dictionary.low);
    throw Error(ErrorKind::input, "'" + beside + "' needs the dictionary " + digest + ", which is not in " + listed(dictionary_folders(beside)) +
                                      ": put its .atoms file there, or name its folder in " + folders_variable);
  };
}

}  // namespace arete
