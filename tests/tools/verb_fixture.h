#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/synthesis/mountains.h"
#include "gis/crs.h"
#include "gis/dem_file.h"

namespace arete {

/// A folder of its own for each test, and the command run in it.
class VerbFixture : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("arete-") + test->test_suite_name() + "-" + test->name() + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "work");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  struct Outcome {
    int code = -1;
    std::string out, err;
    std::int64_t error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
  };
  Outcome run(const std::string& arguments) const {
    const std::string out = (folder_ / "out").string(), err = (folder_ / "err").string();
    const int status = std::system((std::string(ARETE_TOOL) + " " + arguments + " > " + out + " 2> " + err).c_str());
    return {WEXITSTATUS(status), read(out), read(err)};
  }
  std::string path(const std::string& name) const { return (folder_ / "work" / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_ / "work"), std::filesystem::directory_iterator()));
  }
  static std::string read(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  static void write(const std::filesystem::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }
  /// Mountains of 30 m cells in UTM 33, with one void cell.
  std::string write_mountains(const std::string& name, Size size, std::uint64_t seed = 1) const {
    Raster<float> cells = synthesize_mountains(size, {.seed = seed});
    cells(size.width / 2, size.height / 2) = void_value;
    GeoReference geo;
    geo.transform = {500000, 30, 0, 4600000, 0, -30};
    geo.crs_wkt = crs_wkt("EPSG:32633");
    DemWriter writer(path(name), size, geo);
    writer.write(0, {0, 0, size.width, size.height}, cells.view());
    writer.commit();
    return path(name);
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace arete
