#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

constexpr double us_survey_foot_m = 1200.0 / 3937.0;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string wkt_of(const std::string& definition) {
  OGRSpatialReference crs;
  EXPECT_EQ(crs.SetFromUserInput(definition.c_str()), OGRERR_NONE);
  char* text = nullptr;
  crs.exportToWkt(&text);
  std::string wkt = text;
  CPLFree(text);
  return wkt;
}

/// Rough ground between 0 and 3000 m with a tenth of voids.
Raster<float> rough(std::int64_t width, std::int64_t height) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const auto i = static_cast<std::uint64_t>(x), j = static_cast<std::uint64_t>(y);
      cells(x, y) = uniform_at(2, i, j) < 0.1 ? void_value : static_cast<float>(3000 * uniform_at(1, i, j));
    }
  return cells;
}

GeoReference utm(const std::string& definition = "EPSG:32632") {
  GeoReference geo;
  geo.crs_wkt = wkt_of(definition);
  geo.transform = {600000, 30, 0, 5200000, 0, -30};
  return geo;
}

void write_all(const std::string& path, const Raster<float>& cells, const GeoReference& geo, const DemWriteOptions& options = {}) {
  DemWriter writer(path, cells.size(), geo, options);
  writer.write(0, {0, 0, cells.width(), cells.height()}, cells.view());
  writer.commit();
}

void expect_same(const Raster<float>& a, const Raster<float>& b, double relative = 0) {
  ASSERT_EQ(a.size(), b.size());
  std::int64_t wrong = 0;
  for (std::int64_t i = 0; i < a.size().cells(); ++i) {
    const float u = a.data()[i], v = b.data()[i];
    wrong += is_void(u) != is_void(v) || (!is_void(u) && std::fabs(u - v) > relative * std::fabs(u));
  }
  EXPECT_EQ(wrong, 0);
}

ErrorKind kind_of_failure(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.kind();
  }
  ADD_FAILURE() << "no error";
  return ErrorKind::usage;
}

TEST(DemWriter, WritesACloudOptimizedGeoTiffThatReadsBackExactly) {
  TestFolder folder;
  const Raster<float> cells = rough(700, 1100);
  GeoReference geo = utm();
  geo.registration = Registration::point;
  write_all(folder / "out.tif", cells, geo, {.metadata = {{"ARETE_COMMAND", "arete amplify"}}});
  EXPECT_EQ(folder.names(), std::vector<std::string>{"out.tif"});

  const DemReader dem(folder / "out.tif");
  expect_same(cells, read_all(dem));
  EXPECT_EQ(dem.georeference().transform, geo.transform);
  EXPECT_EQ(dem.georeference().registration, Registration::point);
  EXPECT_TRUE(std::isnan(dem.georeference().nodata.value()));
  EXPECT_EQ(dem.georeference().vertical_unit, "m");
  EXPECT_EQ(dem.description().metadata.at("ARETE_COMMAND"), "arete amplify");
  EXPECT_EQ(dem.description().metadata.at("TIFFTAG_SOFTWARE"), "arete " ARETE_VERSION);
  EXPECT_EQ(dem.description().band_names, std::vector<std::string>{"elevation"});

  GDALDatasetUniquePtr tiff(GDALDataset::Open((folder / "out.tif").c_str()));
  EXPECT_STREQ(tiff->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
  EXPECT_STREQ(tiff->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
  EXPECT_GE(tiff->GetRasterBand(1)->GetOverviewCount(), 1);
  EXPECT_STREQ(tiff->GetSpatialRef()->GetAuthorityCode(nullptr), "32632");
}

TEST(DemWriter, GivesTheSameBytesForAnyWindowsMemoryAndThreads) {
  TestFolder folder;
  const Raster<float> cells = rough(1300, 900);
  write_all(folder / "a.tif", cells, utm(), {.threads = 1});
  {
    DemWriter writer(folder / "b.tif", cells.size(), utm(), {.memory_bytes = 2 << 20, .threads = 2});
    for (std::int64_t x = 1200; x >= 0; x -= 100)
      for (std::int64_t y = 0; y < 900; y += 300) writer.write(0, {x, y, 100, 300}, cells.view().sub({x, y, 100, 300}));
    writer.commit();
  }
  EXPECT_EQ(bytes_of(folder / "a.tif"), bytes_of(folder / "b.tif"));
}

TEST(DemWriter, KeepsTheVerticalCrs) {
  TestFolder folder;
  for (const std::string definition : {"EPSG:4326+5773", "EPSG:32632+5773"}) {
    GeoReference geo = utm(definition);
    if (definition == "EPSG:4326+5773") geo.transform = {8, 0.001, 0, 47, 0, -0.001};
    write_all(folder / "v.tif", rough(5, 4), geo, {.overwrite = true});
    OGRSpatialReference crs;
    ASSERT_EQ(crs.importFromWkt(DemReader(folder / "v.tif").georeference().crs_wkt.c_str()), OGRERR_NONE);
    EXPECT_TRUE(crs.IsCompound()) << definition;
    EXPECT_STREQ(crs.GetAuthorityCode("COMPD_CS|VERT_CS"), "5773") << definition;
    // A geographic CRS with heights still has cells of geodesic size.
    const CellSize cell = DemReader(folder / "v.tif").cell_size();
    EXPECT_NEAR(cell.y_m, definition == "EPSG:4326+5773" ? 111.17 : 30, 0.01) << definition;
  }
}

TEST(DemWriter, KeepsTheSourcesNodataAndNeverTurnsAnElevationIntoIt) {
  TestFolder folder;
  for (const double nodata : {-9999.0, 0.0, 1.70141e+38, 500.0}) {
    Raster<float> cells(4, 1, 500);
    cells(1, 0) = void_value;
    cells(2, 0) = 0;
    cells(3, 0) = -9999;
    GeoReference geo = utm();
    geo.nodata = nodata;
    write_all(folder / "n.tif", cells, geo, {.overwrite = true});
    const DemReader dem(folder / "n.tif");
    EXPECT_EQ(dem.georeference().nodata, static_cast<double>(static_cast<float>(nodata)));
    const Raster<float> back = read_all(dem);
    for (int x : {0, 2, 3}) EXPECT_NEAR(back(x, 0), cells(x, 0), 0.001) << nodata;
    EXPECT_TRUE(is_void(back(1, 0))) << nodata;
  }
  GeoReference geo = utm();
  geo.nodata = -1.7976931348623157e308;  // of a Float64 source: no float holds it
  write_all(folder / "n.tif", Raster<float>(2, 1, 1), geo, {.overwrite = true});
  EXPECT_TRUE(std::isnan(DemReader(folder / "n.tif").georeference().nodata.value()));
}

TEST(DemWriter, KeepsTheSourcesUnit) {
  TestFolder folder;
  const Raster<float> metres = rough(60, 50);
  GeoReference geo = utm();
  geo.vertical_unit = "US survey foot";
  geo.metres_per_unit = us_survey_foot_m;
  {
    DemWriter writer(folder / "ft.tif", metres.size(), geo, {.bands = {"elevation", "source"}, .band_units = {"m", ""}});
    writer.write(0, {0, 0, 60, 50}, metres.view());
    writer.write(1, {0, 0, 60, 50}, Raster<float>(60, 50, 17).view());
    writer.commit();
  }
  const DemReader dem(folder / "ft.tif");
  EXPECT_EQ(dem.georeference().vertical_unit, "US survey foot");
  EXPECT_EQ(dem.georeference().metres_per_unit, us_survey_foot_m);
  expect_same(metres, read_all(dem), 1.2e-7);  // two roundings to float
  GDALDatasetUniquePtr tiff(GDALDataset::Open((folder / "ft.tif").c_str()));
  float feet[2];
  ASSERT_EQ(tiff->GetRasterBand(1)->RasterIO(GF_Read, 5, 5, 1, 1, feet, 1, 1, GDT_Float32, 0, 0, nullptr), CE_None);
  ASSERT_EQ(tiff->GetRasterBand(2)->RasterIO(GF_Read, 5, 5, 1, 1, feet + 1, 1, 1, GDT_Float32, 0, 0, nullptr), CE_None);
  EXPECT_NEAR(feet[0], metres(5, 5) * 3937.0 / 1200.0, 0.001);
  EXPECT_EQ(feet[1], 17);
  EXPECT_EQ(dem.description().band_names, (std::vector<std::string>{"elevation", "source"}));
}

TEST(DemWriter, WritesOtherFormats) {
  TestFolder folder;
  const Raster<float> cells = rough(40, 30);
  GeoReference geo = utm();
  for (const std::string name : {"a.asc", "b.img", "c.bil", "d.nc", "e.kea"}) {
    if (name == "e.kea" && GDALGetDriverByName("KEA") == nullptr) continue;
    write_all(folder / name, cells, geo);
    const DemReader dem(folder / name);
    expect_same(cells, read_all(dem));
    ASSERT_TRUE(dem.georeference().transform) << name;
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((*dem.georeference().transform)[i], (*geo.transform)[i], 1e-6) << name;
    EXPECT_NE(dem.georeference().crs_wkt.find("UTM zone 32N"), std::string::npos) << name;
  }
  EXPECT_EQ(DemReader(folder / "a.asc").georeference().nodata, -9999);
  write_all(folder / "plain.tif", cells, geo, {.format = "GTiff"});
  GDALDatasetUniquePtr tiff(GDALDataset::Open((folder / "plain.tif").c_str()));
  EXPECT_EQ(tiff->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), nullptr);
  for (const std::string& name : folder.names()) EXPECT_NE(name[0], '.') << name;

  const auto write = [&](const std::string& name, const std::string& format) {
    return [&, name, format] { DemWriter(folder / name, {4, 4}, geo, {.format = format}); };
  };
  EXPECT_EQ(kind_of_failure(write("out.xyzzy", "")), ErrorKind::format);
  EXPECT_EQ(kind_of_failure(write("noextension", "")), ErrorKind::format);
  EXPECT_EQ(kind_of_failure(write("out.png", "")), ErrorKind::format);
  EXPECT_EQ(kind_of_failure(write("x.tif", "NoSuchFormat")), ErrorKind::format);
}

TEST(DemWriter, RoundTripsARealDem) {
  for (const char* name : {"davosdorf_dtm_10m.tif", "hit_tyrol_dtm_5m.asc", "edge-cases/south_up_250x250.tif",
                           "edge-cases/all_nodata_74x92.tif", "edge-cases/tiny_6x4.tif", "edge-cases/no_crs_6x4.tif"}) {
    const std::string path = test_data(name);
    if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
    TestFolder folder;
    const DemReader source(path);
    const Raster<float> cells = read_all(source);
    write_all(folder / "copy.tif", cells, source.georeference());
    const DemReader copy(folder / "copy.tif");
    expect_same(cells, read_all(copy));
    EXPECT_EQ(copy.georeference().registration, source.georeference().registration) << name;
    EXPECT_EQ(copy.georeference().transform, source.georeference().transform) << name;
    EXPECT_EQ(copy.georeference().crs_wkt.empty(), source.georeference().crs_wkt.empty()) << name;
  }
}

TEST(DemWriter, CellsThatAreNeverWrittenAreVoid) {
  TestFolder folder;
  {
    DemWriter writer(folder / "half.tif", {1200, 10}, utm());
    writer.write(0, {0, 0, 100, 10}, Raster<float>(100, 10, 5).view());
    writer.commit();
  }
  const Raster<float> cells = read_all(DemReader(folder / "half.tif"));
  EXPECT_EQ(cells(99, 9), 5);
  EXPECT_TRUE(is_void(cells(100, 0)) && is_void(cells(1199, 9)));
}

TEST(DemWriter, WithoutCommitNothingAppears) {
  TestFolder folder;
  {
    DemWriter writer(folder / "out.tif", {100, 100}, utm());
    writer.write(0, {0, 0, 100, 100}, rough(100, 100).view());
    for (const std::string& name : folder.names()) EXPECT_EQ(name[0], '.');
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(DemWriter, NeverTouchesAnExistingOutputUnlessTold) {
  TestFolder folder;
  std::ofstream(folder / "out.tif") << "precious";
  EXPECT_EQ(kind_of_failure([&] { write_all(folder / "out.tif", rough(9, 9), utm()); }), ErrorKind::disk);
  EXPECT_EQ(bytes_of(folder / "out.tif"), "precious");
  {
    DemWriter given_up(folder / "out.tif", {9, 9}, utm(), {.overwrite = true});
  }
  EXPECT_EQ(bytes_of(folder / "out.tif"), "precious");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"out.tif"});
  std::ofstream(folder / "out.tif.aux.xml") << "<PAMDataset><Metadata><MDI key=\"OLD\">1</MDI></Metadata></PAMDataset>";
  write_all(folder / "out.tif", rough(9, 9), utm(), {.overwrite = true});
  EXPECT_EQ(DemReader(folder / "out.tif").description().metadata.count("OLD"), 0u);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"out.tif"});

  // One that appears while the work goes on.
  DemWriter late(folder / "late.tif", {9, 9}, utm());
  std::ofstream(folder / "late.tif") << "precious";
  EXPECT_EQ(kind_of_failure([&] { late.commit(); }), ErrorKind::disk);
  EXPECT_EQ(bytes_of(folder / "late.tif"), "precious");
}

TEST(DemWriter, RefusesFoldersThatCannotBeWrittenTo) {
  TestFolder folder;
  const auto writing = [&](const std::string& path) {
    return [&, path] { DemWriter(path, {4, 4}, utm()); };
  };
  EXPECT_EQ(kind_of_failure(writing(folder / "missing/out.tif")), ErrorKind::disk);
  std::ofstream(folder / "file") << "x";
  EXPECT_EQ(kind_of_failure(writing(folder / "file/out.tif")), ErrorKind::disk);
  std::filesystem::create_directory(folder / "dir.tif");
  EXPECT_EQ(kind_of_failure(writing(folder / "dir.tif")), ErrorKind::disk);
  EXPECT_EQ(kind_of_failure(writing("/proc/out.tif")), ErrorKind::disk);  // no one can make a file there, not even root
  EXPECT_EQ(kind_of_failure(writing("/vsimem/out.tif")), ErrorKind::usage);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"dir.tif", "file"}));
}

class Impatient final : public Progress {
 public:
  void begin(const std::string&, std::int64_t) override {}
  void advance(std::int64_t) override { throw Error(ErrorKind::interrupted, "interrupted"); }
  void end() override {}
};

TEST(DemWriter, StopsWhenTheUserSaysSo) {
  TestFolder folder;
  DemWriter writer(folder / "out.tif", {1500, 1500}, utm());
  writer.write(0, {0, 0, 1500, 1500}, rough(1500, 1500).view());
  Impatient impatient;
  EXPECT_EQ(kind_of_failure([&] { writer.commit(&impatient); }), ErrorKind::interrupted);
  for (const std::string& name : folder.names()) EXPECT_EQ(name[0], '.');
}

/// Writes in a child process that may write no file of more than `limit` bytes. Returns its exit code: 0 success, 5 Error{disk},
/// 1 anything else; 99 when the child printed something on stderr.
int write_with_limit(const std::string& path, const Raster<float>& cells, rlim_t limit, ValueType type, const std::string& log) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    if (std::freopen(log.c_str(), "w", stderr) == nullptr) _exit(1);
    const rlimit most{limit, limit};
    setrlimit(RLIMIT_FSIZE, &most);
    int code = 0;
    try {
      write_all(path, cells, utm(), {.type = type, .threads = 1});
    } catch (const Error& error) {
      code = error.kind() == ErrorKind::disk ? 5 : 1;
    } catch (...) {
      code = 1;
    }
    std::fflush(stderr);
    _exit(std::filesystem::file_size(log) > 0 ? 99 : code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

// The limit falls into the temporary copy, its overviews, and the output in turn; noise does not compress, so that both are large.
TEST(DemWriter, AFullDiskIsAnErrorAndLeavesNothing) {
  TestFolder folder, logs;
  const Raster<float> cells = rough(700, 700);
  for (const ValueType type : {ValueType::float32, ValueType::int32}) {
    write_all(folder / "whole.tif", cells, utm(), {.type = type});
    const std::string whole = bytes_of(folder / "whole.tif");
    std::filesystem::remove(folder / "whole.tif");
    int failures = 0, successes = 0;
    for (rlim_t limit = 0; limit < (rlim_t{6} << 20); limit = limit < 4096 ? limit + 1024 : limit + 400001) {
      const int code = write_with_limit(folder / "out.tif", cells, limit, type, logs / "log");
      if (code == 0) {
        ++successes;
        EXPECT_EQ(bytes_of(folder / "out.tif"), whole) << limit;
        std::filesystem::remove(folder / "out.tif");
      } else {
        ++failures;
        EXPECT_EQ(code, 5) << limit << ": " << bytes_of(logs / "log");
      }
      EXPECT_TRUE(folder.names().empty()) << limit;
    }
    EXPECT_GT(failures, 8);
    EXPECT_GT(successes, 3);
  }
}

}  // namespace
}  // namespace arete
