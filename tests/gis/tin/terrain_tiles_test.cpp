#include "gis/tin/terrain_tiles.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "gis/mesh/check_terrain_tiles.h"
#include "tests/data.h"
#include "tests/gis/dem_files.h"

namespace arete {
namespace {

/// Hills with a rough surface and a void in the middle.
Raster<float> make_hills(std::int64_t width, std::int64_t height, bool with_void) {
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      cells(x, y) = static_cast<float>(500 + 200 * std::sin(static_cast<double>(x) / 17) * std::cos(static_cast<double>(y) / 23) + 12 * uniform_at(5, x, y));
  if (with_void)
    for (std::int64_t y = height / 3; y < height / 2; ++y)
      for (std::int64_t x = width / 3; x < width / 2; ++x) cells(x, y) = void_value;
  return cells;
}

GeoReference utm() {
  GeoReference geo;
  geo.transform = {499000, 30, 0, 5200000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32632");
  return geo;
}

GeoReference degrees(double west) {
  GeoReference geo;
  geo.transform = {west, 1.0 / 3600, 0, 10.01, 0, -1.0 / 3600};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  return geo;
}

std::map<std::string, std::string> bytes_of(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) {
      std::ifstream in(entry.path(), std::ios::binary);
      files[std::filesystem::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    }
  return files;
}

TerrainTilesReport make(const RasterSource& raster, const GeoReference& geo, const std::string& folder, double bound, bool fill = false, int threads = 2) {
  std::filesystem::create_directories(folder);
  TerrainTilesOptions options;
  options.max_error_m = bound;
  options.fill = fill;
  options.threads = threads;
  NoProgress progress;
  return write_terrain_tiles(raster, geo, folder, options, progress);
}

void expect_sound(const RasterSource& raster, const GeoReference& geo, const std::string& folder, double bound) {
  NoProgress progress;
  const TerrainTilesCheck check = check_terrain_tiles(folder, TerrainTruth{raster, geo}, bound, 2, progress);
  EXPECT_EQ(check.faults, std::vector<std::string>{});
  EXPECT_EQ(check.compared_cells, check.valid_cells);
  EXPECT_GT(check.compared_cells, 0);
  EXPECT_LE(check.max_error_m, bound);
}

/// Reads the set by the text of the specification alone, and compares it with points of the raster.
void expect_python_agrees(const RasterSource& raster, const GeoReference& geo, const std::string& folder, const std::string& points, double bound) {
  const Raster<float> cells = read_all(raster);
  const auto& t = *geo.transform;
  std::ofstream out(points);
  out.precision(17);
  for (std::int64_t y = 0; y < cells.height(); y += 3)
    for (std::int64_t x = 0; x < cells.width(); x += 3)
      if (!is_void(cells(x, y)))
        out << t[0] + (static_cast<double>(x) + 0.5) * t[1] << " " << t[3] + (static_cast<double>(y) + 0.5) * t[5] << " " << cells(x, y) << "\n";
  out.close();
  const std::string command = std::string(ARETE_TEST_PYTHON) + " -B " + ARETE_SOURCE_DIR + "/tests/gis/mesh/read_terrain.py " + folder + " " + points + " " +
                              std::to_string(bound) + " > /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

TEST(TerrainTiles, EveryCellKeepsTheBoundAndNeighboursAgree) {
  const TestFolder folder;
  for (const bool with_void : {false, true})
    for (const bool fill : {false, true}) {
      const Raster<float> cells = make_hills(150, 130, with_void);
      const ViewSource raster(cells.view());
      const std::string tiles = folder / ("tiles" + std::to_string(with_void) + std::to_string(fill));
      const TerrainTilesReport report = make(raster, utm(), tiles, 4, fill);
      EXPECT_LE(report.max_error_m, 4);
      expect_sound(raster, utm(), tiles, 4);
    }
}

TEST(TerrainTiles, TheSpecificationAloneReadsThem) {
  const TestFolder folder;
  const Raster<float> cells = make_hills(120, 100, true);
  const ViewSource raster(cells.view());
  make(raster, degrees(20), folder / "tiles", 3);
  expect_sound(raster, degrees(20), folder / "tiles", 3);
  expect_python_agrees(raster, degrees(20), folder / "tiles", folder / "points.txt", 3);
}

TEST(TerrainTiles, TheAntimeridianIsNoBorder) {
  const TestFolder folder;
  const Raster<float> cells = make_hills(120, 60, false);
  const ViewSource raster(cells.view());
  make(raster, degrees(179.98), folder / "tiles", 5);
  expect_sound(raster, degrees(179.98), folder / "tiles", 5);
}

TEST(TerrainTiles, BytesDoNotDependOnThreads) {
  const TestFolder folder;
  const Raster<float> cells = make_hills(120, 100, true);
  const ViewSource raster(cells.view());
  make(raster, utm(), folder / "one", 5, false, 1);
  make(raster, utm(), folder / "three", 5, false, 3);
  EXPECT_EQ(bytes_of(folder / "one"), bytes_of(folder / "three"));
}

TEST(TerrainTiles, ABoundBelowWhat15BitsHoldIsRefusedWithTheSmallest) {
  const TestFolder folder;
  const Raster<float> cells = make_hills(60, 60, false);
  const ViewSource raster(cells.view());
  try {
    make(raster, utm(), folder / "tiles", 0.001);
    FAIL() << "a step of heights is 2^-6 m and more here";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("their smallest is 0.0"), std::string::npos) << error.what();
  }
}

TEST(TerrainTiles, AMovedVertexIsFound) {
  const TestFolder folder;
  const Raster<float> cells = make_hills(60, 60, false);
  const ViewSource raster(cells.view());
  const TerrainTilesReport report = make(raster, utm(), folder / "tiles", 5);
  // A height of a tile of the deepest level: the first of its 16-bit codes of heights, after 88 bytes, the count, u and v.
  std::filesystem::path largest;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / ("tiles/" + std::to_string(report.levels.size() - 1))))
    if (entry.is_regular_file() && (largest.empty() || entry.file_size() > std::filesystem::file_size(largest))) largest = entry.path();
  std::fstream file(largest, std::ios::binary | std::ios::in | std::ios::out);
  std::uint32_t count = 0;
  file.seekg(88).read(reinterpret_cast<char*>(&count), 4);
  std::uint16_t code = 0;
  file.seekg(92 + 4 * count).read(reinterpret_cast<char*>(&code), 2);
  code = static_cast<std::uint16_t>(code >= 4000 ? code - 4000 : code + 4000);
  file.seekp(92 + 4 * count).write(reinterpret_cast<const char*>(&code), 2);
  file.close();
  NoProgress progress;
  try {
    EXPECT_FALSE(check_terrain_tiles(folder / "tiles", TerrainTruth{raster, utm()}, 5, 1, progress).faults.empty());
  } catch (const Error& error) {  // a height beyond 32767
    EXPECT_EQ(error.kind(), ErrorKind::input);
  }
}

TEST(TerrainTiles, RealTerrainKeepsItsBound) {
  for (const auto& [name, bound] : {std::pair{"davosdorf_dtm_10m.tif", 5.0}, {"recife_srtm1_1arcsec_coast.tif", 3.0}}) {
    const std::string path = test_data(name);
    if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
    const TestFolder folder;
    const DemReader dem(path);
    make(dem, dem.georeference(), folder / "tiles", bound);
    expect_sound(dem, dem.georeference(), folder / "tiles", bound);
    if (summarise_crs(dem.georeference().crs_wkt).geographic) expect_python_agrees(dem, dem.georeference(), folder / "tiles", folder / "points.txt", bound);
  }
}

}  // namespace
}  // namespace arete
