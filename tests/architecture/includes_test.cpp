// The arrows of the design: core <- gis <- tools, core <- shaders <- tools, tests see all, nothing sees tests; a third-party header only in its folder.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

struct Source {
  std::string path;                   // from the root, with '/'
  std::vector<std::string> own;       // "..." includes
  std::vector<std::string> foreign;   // <...> includes
  int lines = 0;
};

std::string folder_of(const std::string& path) { return path.substr(0, path.find('/')); }

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes)
    if (text.rfind(prefix, 0) == 0) return true;
  return false;
}

Source read_source(const fs::path& root, const fs::path& file) {
  static const std::regex include(R"(^\s*#\s*include\s*(["<])([^">]+)[">])");
  Source source{fs::relative(file, root).generic_string(), {}, {}, 0};
  std::ifstream in(file);
  for (std::string line; std::getline(in, line); ++source.lines) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    (match[1] == "\"" ? source.own : source.foreign).push_back(match[2]);
  }
  return source;
}

const std::vector<Source>& sources() {
  static const std::vector<Source> all = [] {
    std::vector<Source> found;
    const fs::path root = ARETE_SOURCE_DIR;
    for (const char* folder : {"core", "gis", "shaders", "tools", "tests"}) {
      if (!fs::exists(root / folder)) continue;
      for (const auto& entry : fs::recursive_directory_iterator(root / folder))
        if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
          found.push_back(read_source(root, entry.path()));
    }
    return found;
  }();
  return all;
}

/// Headers of the C++ standard library have neither a dot nor a slash; the few of POSIX and libc are listed.
bool is_system_header(const std::string& header) {
  static const std::set<std::string> posix = {"unistd.h", "fcntl.h", "dirent.h", "sys/stat.h", "sys/types.h", "sys/wait.h",
                                              "sys/mman.h", "dlfcn.h", "sys/resource.h", "sys/time.h", "stdio.h",
                                              "stdlib.h", "signal.h"};
  return header.find_first_of("./") == std::string::npos || posix.count(header) > 0;
}

TEST(Architecture, TheSourcesAreFound) { EXPECT_GT(sources().size(), 20u); }

TEST(Architecture, FoldersSeeOnlyWhatTheArrowsAllow) {
  const std::map<std::string, std::vector<std::string>> may_see = {
      {"core", {"core/"}},
      {"gis", {"core/", "gis/"}},
      {"shaders", {"core/", "shaders/"}},
      {"tools", {"core/", "gis/", "shaders/", "tools/"}},
      {"tests", {"core/", "gis/", "shaders/", "tools/", "tests/"}}};
  for (const Source& source : sources())
    for (const std::string& header : source.own)
      EXPECT_TRUE(starts_with_any(header, may_see.at(folder_of(source.path)))) << source.path << " includes " << header;
}

TEST(Architecture, AnIncludedFileOfOursExists) {
  for (const Source& source : sources())
    for (const std::string& header : source.own)
      EXPECT_TRUE(fs::exists(fs::path(ARETE_SOURCE_DIR) / header)) << source.path << " includes " << header;
}

TEST(Architecture, ThirdPartyHeadersStayInTheirFolders) {
  const std::map<std::string, std::vector<std::string>> may_see = {
      {"core", {"Eigen/", "unsupported/Eigen/", "tbb/", "oneapi/tbb", "hwy/", "flann/", "xxhash.h", "zlib.h", "zstd.h", "cblas.h"}},
      {"gis", {"gdal", "ogr", "cpl_", "vrtdataset.h", "GeographicLib/", "OpenImageIO/", "CGAL/", "openjpeg.h", "jxl/",
               "expat.h", "draco/", "netcdf.h", "nlohmann/"}},
      {"shaders", {"epoxy/", "GLFW/"}},
      {"tools", {"CLI/", "nlohmann/", "spdlog/", "fmt/"}}};
  for (const Source& source : sources()) {
    const auto allowed = may_see.find(folder_of(source.path));
    if (allowed == may_see.end()) continue;
    for (const std::string& header : source.foreign)
      EXPECT_TRUE(is_system_header(header) || starts_with_any(header, allowed->second))
          << source.path << " includes <" << header << '>';
  }
}

TEST(Architecture, FlannIsSeenByOneFileOfCoreSparse) {
  std::vector<std::string> users;
  for (const Source& source : sources())
    for (const std::string& header : source.foreign)
      if (header.rfind("flann/", 0) == 0) users.push_back(source.path);
  std::set<std::string> files(users.begin(), users.end());
  EXPECT_LE(files.size(), 1u);
  for (const std::string& file : files) {
    EXPECT_EQ(file.rfind("core/sparse/", 0), 0u) << file;
    EXPECT_EQ(fs::path(file).extension(), ".cpp") << file;
  }
}

TEST(Architecture, EveryAlgorithmOfCoreHasItsTest) {
  for (const Source& source : sources()) {
    const fs::path path(source.path);
    if (folder_of(source.path) != "core" || path.extension() != ".cpp") continue;
    const fs::path test = fs::path("tests") / path.parent_path() / (path.stem().string() + "_test.cpp");
    EXPECT_TRUE(fs::exists(fs::path(ARETE_SOURCE_DIR) / test)) << source.path << " has no " << test.generic_string();
  }
}

TEST(Architecture, NoFileIsLongerThan600Lines) {
  for (const Source& source : sources()) EXPECT_LE(source.lines, 600) << source.path;
}

}  // namespace
