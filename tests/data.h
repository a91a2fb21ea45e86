#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace arete {

/// The path of a real DEM of the development data ("davosdorf_dtm_10m.tif"), or empty where the data is absent: skip the test then.
/// The folder is $ARETE_TEST_DATA, else ../shared/data beside the sources.
inline std::string test_data(const std::string& name) {
  const char* folder = std::getenv("ARETE_TEST_DATA");
  const std::filesystem::path path = std::filesystem::path(folder != nullptr ? folder : ARETE_SOURCE_DIR "/../shared/data") / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

}  // namespace arete
