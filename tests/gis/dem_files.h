#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "core/terrain/raster.h"

namespace arete {

/// A folder of its own for a test, removed with what it holds.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "arete-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  /// Names of all that lies in it, hidden or not.
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  std::filesystem::path path_;
};

/// Writes `cells` (row-major, all bands one after the other) with GDAL itself, as other programs would; `adjust` sets the rest.
inline void make_raster(const std::string& path, int width, int height, GDALDataType type, const std::vector<double>& cells,
                        const std::function<void(GDALDataset&)>& adjust = {}, const char* driver = "GTiff",
                        const char* const* creation = nullptr) {
  GDALAllRegister();
  const int bands = static_cast<int>(cells.size()) / (width * height);
  GDALDatasetUniquePtr dataset(
      GetGDALDriverManager()->GetDriverByName(driver)->Create(path.c_str(), width, height, bands, type, creation));
  ASSERT_NE(dataset, nullptr);
  if (adjust) adjust(*dataset);
  for (int band = 0; band < bands; ++band) {
    std::vector<double> values(cells.begin() + band * width * height, cells.begin() + (band + 1) * width * height);
    ASSERT_EQ(dataset->GetRasterBand(band + 1)->RasterIO(GF_Write, 0, 0, width, height, values.data(), width, height, GDT_Float64, 0,
                                                         0, nullptr),
              CE_None);
  }
}

}  // namespace arete
