#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/sparse/dictionary_file.h"
#include "core/support/file.h"
#include "gis/image.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

using testing::HasSubstr;

class InfoDictionary : public testing::Test {
 protected:
  struct Outcome {
    int code = -1;
    std::string out, err;
  };

  static std::string slurp(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  Outcome run_info(const std::string& arguments) const {
    const std::string command =
        std::string(ARETE_TOOL) + " info " + arguments + " > " + (folder_ / "out") + " 2> " + (folder_ / "err");
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), slurp(folder_ / "out"), slurp(folder_ / "err")};
  }

  static Dictionary small_dictionary() {
    Dictionary d;
    d.method = LearningMethod::ksvd;
    d.patch_cells = 4;
    d.factor = 2;
    d.cell_size_m = 30;
    d.low = Eigen::MatrixXf::Identity(16, 3);
    d.high = Eigen::MatrixXf::Identity(64, 3);
    d.detail = d.high;
    d.sources = {{0, 0, 0, 0}, {0, 4, 0, 5}, {-1, 0, 0, 0}};
    d.exemplars = {"davos.tif", "unused.tif"};
    d.upsampler = Upsampler{2, 1, std::vector<float>(36, 0)};
    d.detail_power = 0.015625;
    d.provenance = "arete learn davos.tif unused.tif\n\033[2Jx.atoms";
    return d;
  }

  TestFolder folder_;
};

TEST_F(InfoDictionary, SaysWhatItHolds) {
  const std::string path = folder_ / "no extension";
  write_dictionary(path, small_dictionary(), false);
  const auto data = nlohmann::json::parse(run_info("--json '" + path + "'").out);
  EXPECT_EQ(data["kind"], "dictionary");
  EXPECT_EQ(data["digest"], dictionary_digest(small_dictionary()));
  EXPECT_EQ(data["bytes"], std::filesystem::file_size(path));
  EXPECT_EQ(data["method"], "ksvd");
  EXPECT_EQ(data["atoms"], 3);
  EXPECT_EQ(data["factor"], 2);
  EXPECT_EQ(data["radius_m"], 60);
  EXPECT_EQ(data["detail_power"], 0.015625);
  EXPECT_EQ(data["upsampler"]["reach"], 1);
  EXPECT_EQ(data["exemplars"][0]["name"], "davos.tif");
  EXPECT_EQ(data["exemplars"][0]["atoms"], 2);
  EXPECT_EQ(data["exemplars"][1]["atoms"], 0);
  EXPECT_EQ(data["atoms_without_source"], 1);
  EXPECT_EQ(data["atoms_turned"], 1);
  EXPECT_EQ(data["provenance"], small_dictionary().provenance);

  const Outcome outcome = run_info("'" + path + "'");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("3 of 4 x 4 cells, and 2 times finer: 8 x 8, with detail"));
  EXPECT_THAT(outcome.out, HasSubstr("60 m, 2 cells of 30 m"));
  EXPECT_THAT(outcome.out, HasSubstr("davos.tif: 2 atoms"));
  // What would steer the terminal does not reach it.
  EXPECT_EQ(outcome.out.find('\033'), std::string::npos);
}

TEST_F(InfoDictionary, DrawsItsAtoms) {
  const std::string path = folder_ / "x.atoms", sheet = folder_ / "sheet.png";
  write_dictionary(path, small_dictionary(), false);
  EXPECT_EQ(run_info(path + " --sheet " + sheet).code, 0);
  EXPECT_GT(read_picture(sheet).width(), 3 * 8);
  const std::string before = slurp(sheet);
  const Outcome again = run_info(path + " --sheet " + sheet);
  EXPECT_EQ(again.code, 5);
  EXPECT_EQ(std::count(again.err.begin(), again.err.end(), '\n'), 1) << again.err;
  EXPECT_EQ(run_info(path + " --overwrite --sheet " + sheet).code, 0);
  EXPECT_EQ(slurp(sheet), before);
  EXPECT_EQ(run_info(path + " --sheet " + (folder_ / "none/sheet.png")).code, 5);
}

TEST_F(InfoDictionary, DamagedFilesAreOneLineAndTheirOwnCode) {
  const std::string path = folder_ / "x.atoms";
  std::vector<std::byte> bytes = encode_dictionary(small_dictionary());
  const auto expect_failure = [&](int code) {
    write_file_atomically(path, bytes, true);
    const Outcome outcome = run_info(path + " --sheet " + (folder_ / "sheet.png"));
    EXPECT_EQ(outcome.code, code);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "sheet.png"));
  };
  bytes[bytes.size() / 2] ^= std::byte{1};
  expect_failure(8);
  bytes[bytes.size() / 2] ^= std::byte{1};
  bytes[16] = std::byte{2};  // the version
  expect_failure(4);
  bytes.resize(100);
  bytes[16] = std::byte{1};
  expect_failure(8);
}

TEST_F(InfoDictionary, OnlyADictionaryHasASheet) {
  std::ofstream(folder_ / "text.tif") << "no raster";
  const Outcome outcome = run_info((folder_ / "text.tif") + " --sheet " + (folder_ / "sheet.png"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--sheet"));
}

}  // namespace
}  // namespace arete
