#include "gis/tin/make_tin.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <ostream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "gis/mesh/check_mesh.h"
#include "gis/tin/placed_mesh.h"
#include "tests/data.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

double random_share(std::uint64_t seed, std::uint64_t x, std::uint64_t y) { return static_cast<double>(hash_position(seed, x, y) >> 11) * 0x1p-53; }

TinOptions with_passes(int passes) {
  TinOptions options;
  options.passes = passes;
  return options;
}

TinOptions with_threads(int threads, const Scratch& scratch = {}) {
  TinOptions options;
  options.threads = threads;
  options.scratch = scratch;
  return options;
}

Tin mesh_of(const RasterSource& raster, double max_error, TinOptions options = {}) {
  NoProgress silent;
  options.max_error_m = max_error;
  return make_tin(raster, options, silent);
}

/// What an independent check finds wrong with a mesh that lies in the plane of its raster.
std::vector<std::string> faults(const Tin& tin, const RasterSource& raster, double max_error, const GeoReference& geo = {}) {
  NoProgress silent;
  const PlacedMesh mesh(tin.mesh, geo, raster.size(), {});
  MeshCheckOptions options;
  options.max_error_m = max_error;
  const MeshErrors errors = check_mesh(mesh, mesh.frame(), raster, geo, options, silent);
  std::vector<std::string> found = faults_of(errors, options);
  if (std::abs(errors.max_error_m - tin.report.max_error_m) > 1e-4 + 1e-6 * max_error) found.push_back("another largest error than reported");
  if (std::abs(errors.rmse_m - tin.report.rmse_m) > 1e-4 * (1 + max_error)) found.push_back("another RMSE than reported");
  if (errors.valid_cells != tin.report.cells) found.push_back("another number of cells than reported");
  return found;
}

std::vector<MeshVertex> vertices_of(const MeshSource& mesh) {
  std::vector<MeshVertex> vertices(static_cast<std::size_t>(mesh.vertices()));
  mesh.read_vertices(0, vertices);
  return vertices;
}

std::vector<MeshTriangle> triangles_of(const MeshSource& mesh) {
  std::vector<MeshTriangle> triangles(static_cast<std::size_t>(mesh.triangles()));
  mesh.read_triangles(0, triangles);
  return triangles;
}

/// A small raster of any kind: whole or real elevations, smooth or rough, with or without voids.
Raster<float> random_raster(std::uint64_t seed) {
  const auto draw = [&](std::uint64_t what) { return random_share(seed, 1u << 20, what); };
  const auto width = static_cast<std::int64_t>(2 + draw(0) * 38), height = static_cast<std::int64_t>(2 + draw(1) * 38);
  const bool whole = draw(2) < 0.5;
  const double relief = std::pow(10.0, draw(3) * 4 - 1), base = draw(4) * 2000 - 200, void_share = draw(5) < 0.4 ? 0 : draw(6) * draw(6);
  const auto block = static_cast<std::int64_t>(1 + draw(7) * 6);
  Raster<float> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      const auto ux = static_cast<std::uint64_t>(x), uy = static_cast<std::uint64_t>(y);
      double h = base + relief * (std::sin(static_cast<double>(x) / 5) + random_share(seed + 1, ux, uy) * draw(8));
      if (whole) h = std::round(h);
      const bool is_hole = random_share(seed + 2, ux / static_cast<std::uint64_t>(block), uy / static_cast<std::uint64_t>(block)) < void_share;
      cells(x, y) = is_hole ? void_value : static_cast<float>(h);
    }
  return cells;
}

TEST(MakeTin, AnyRasterKeepsAnyBound) {
  int meshed = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    const HeldRaster raster(random_raster(seed));
    const double bounds[] = {0.001, 0.25, 0.5, 1, 2, 7.3, 100};
    const double bound = bounds[seed % 7];
    Tin tin;
    try {
      tin = mesh_of(raster, bound, with_passes(seed % 5 == 0 ? 0 : 3));
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("no valid cell")) << seed;
      continue;
    }
    ++meshed;
    EXPECT_THAT(faults(tin, raster, bound), IsEmpty()) << "seed " << seed << ", bound " << bound;
  }
  EXPECT_GT(meshed, 500);
}

TEST(MakeTin, TilesJoinToOneManifold) {
  const HeldRaster raster(noisy_waves(2300, 1600, 3));
  const Tin tin = mesh_of(raster, 5);
  EXPECT_THAT(faults(tin, raster, 5), IsEmpty());
  NoProgress silent;
  const MeshTopology topology = mesh_topology(tin.mesh, std::int64_t{1} << 30, silent);
  EXPECT_EQ(topology.non_manifold_edges, 0);
}

TEST(MakeTin, ThreadsAndMemoryDoNotShow) {
  Raster<float> cells = noisy_waves(1900, 1600, 3);
  for (std::int64_t x = 900; x < 1100; ++x) cells(x, 1000 + x % 50) = void_value;
  const HeldRaster raster(std::move(cells));
  const Tin one = mesh_of(raster, 4, with_threads(1));
  EXPECT_THAT(faults(one, raster, 4), IsEmpty());
  const Scratch little{std::int64_t{1} << 20, std::filesystem::temp_directory_path().string()};
  for (const TinOptions& options : {with_threads(2), with_threads(5), with_threads(2, little)}) {
    const Tin other = mesh_of(raster, 4, options);
    EXPECT_EQ(vertices_of(one.mesh), vertices_of(other.mesh));
    EXPECT_EQ(triangles_of(one.mesh), triangles_of(other.mesh));
    EXPECT_EQ(one.report.rmse_m, other.report.rmse_m);
  }
}

TEST(MakeTin, SimplificationSavesAFifthAndMore) {
  const HeldRaster raster(noisy_waves(500, 400, 6));
  const Tin greedy = mesh_of(raster, 4, with_passes(0)), simplified = mesh_of(raster, 4);
  EXPECT_LT(static_cast<double>(simplified.report.triangles), 0.8 * static_cast<double>(greedy.report.triangles));
}

TEST(MakeTin, APlaneIsTwoTriangles) {
  Raster<float> cells(300, 200);
  for (std::int64_t y = 0; y < 200; ++y)
    for (std::int64_t x = 0; x < 300; ++x) cells(x, y) = static_cast<float>(100 + 2 * x - 3 * y);
  const Tin tin = mesh_of(HeldRaster(std::move(cells)), 0.01);
  EXPECT_EQ(tin.report.triangles, 2);
  EXPECT_EQ(tin.report.full_triangles, 2 * 299 * 199);
  EXPECT_EQ(tin.report.max_error_m, 0);
}

TEST(MakeTin, FourCellsAreTwoTriangles) {
  Raster<float> cells(2, 2, 5.0f);
  cells(1, 1) = 90;
  const HeldRaster raster(std::move(cells));
  const Tin tin = mesh_of(raster, 0.5);
  EXPECT_EQ(tin.report.triangles, 2);
  EXPECT_EQ(tin.report.vertices, 4);
  EXPECT_EQ(tin.report.max_error_m, 0);
  EXPECT_THAT(faults(tin, raster, 0.5), IsEmpty());
}

TEST(MakeTin, OneCellOfFourIsAQuarterSquare) {
  Raster<float> cells(2, 2, void_value);
  cells(1, 0) = 5;
  const HeldRaster raster(std::move(cells));
  const Tin tin = mesh_of(raster, 1);
  EXPECT_EQ(tin.report.triangles, 2);
  EXPECT_THAT(faults(tin, raster, 1), IsEmpty());
}

// Whole metres: an error may be the bound itself, and no rounding may decide about it.
TEST(MakeTin, AnErrorThatIsTheBoundIsWithinIt) {
  Raster<float> cells(30, 20, 100.0f);
  cells(11, 7) = 103;
  const HeldRaster raster(std::move(cells));
  const Tin at = mesh_of(raster, 3), below = mesh_of(raster, std::nextafter(3.0f, 0.0f));
  EXPECT_EQ(at.report.triangles, 2);
  EXPECT_GT(below.report.triangles, 2);
  EXPECT_THAT(faults(at, raster, 3), IsEmpty());
  const HeldRaster steps(std::invoke([] {
    Raster<float> whole = noisy_waves(90, 70, 40);
    for (std::int64_t i = 0; i < whole.size().cells(); ++i) whole.data()[i] = std::round(whole.data()[i]);
    return whole;
  }));
  for (const double bound : {1.0, 2.0, 4.0, 8.0}) {
    const Tin tin = mesh_of(steps, bound);
    EXPECT_EQ(tin.report.max_error_m, bound);  // reached by one cell of 6300 at least
    EXPECT_THAT(faults(tin, steps, bound), IsEmpty());
  }
}

TEST(MakeTin, AnIslandOfOneCellIsASquare) {
  Raster<float> cells(9, 9, void_value);
  cells(4, 4) = 7;
  const HeldRaster raster(std::move(cells));
  const Tin tin = mesh_of(raster, 1);
  EXPECT_EQ(tin.report.triangles, 2);
  EXPECT_EQ(tin.report.cells, 1);
  EXPECT_THAT(faults(tin, raster, 1), IsEmpty());
}

TEST(MakeTin, EdgesAreNoLongerThanAllowed) {
  const HeldRaster raster(Raster<float>(400, 300, 5.0f));
  TinOptions options;
  options.displacement.longest_cells = 50;
  const Tin tin = mesh_of(raster, 1, options);
  EXPECT_THAT(faults(tin, raster, 1), IsEmpty());
  const std::vector<MeshVertex> vertices = vertices_of(tin.mesh);
  for (const MeshTriangle& t : triangles_of(tin.mesh))
    for (std::size_t k = 0; k < 3; ++k) {
      const MeshVertex &a = vertices[static_cast<std::size_t>(t[k])], &b = vertices[static_cast<std::size_t>(t[(k + 1) % 3])];
      EXPECT_LE(std::hypot(a.x - b.x, a.y - b.y), 50);
    }
}

TEST(MakeTin, RefusesWhatHasNoSurface) {
  EXPECT_THROW(mesh_of(HeldRaster(Raster<float>(1, 1, 3.0f)), 1), Error);
  EXPECT_THROW(mesh_of(HeldRaster(Raster<float>(50, 1, 3.0f)), 1), Error);
  EXPECT_THROW(mesh_of(HeldRaster(Raster<float>(50, 40, void_value)), 1), Error);
  EXPECT_THROW(mesh_of(HeldRaster(Raster<float>(50, 40, 3.0f)), 0), Error);
  EXPECT_THROW(mesh_of(HeldRaster(Raster<float>(50, 40, 3.0f)), -1), Error);
  EXPECT_THROW(mesh_of(HeldRaster(Raster<float>(50, 40, 3.0f)), std::nan("")), Error);
}

TEST(MakeTin, SaysTheLeastBoundThatTheRoundingAllows) {
  const HeldRaster raster(noisy_waves(60, 50, 100));
  TinOptions options;
  options.displacement.rounding_cells = 0.01;
  try {
    mesh_of(raster, 0.1, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::format);
    EXPECT_THAT(error.what(), HasSubstr("at least"));
  }
  EXPECT_THAT(faults(mesh_of(raster, 3, options), raster, 3), IsEmpty());
}

/// Waves in degrees about a void with long straight sides.
Raster<float> waves_with_a_lake() {
  Raster<float> cells = noisy_waves(700, 400, 0);
  for (std::int64_t y = 60; y < 340; ++y)
    for (std::int64_t x = 50; x < 640; ++x) cells(x, y) = void_value;
  return cells;
}

GeoReference degrees(double step) {
  GeoReference geo;
  geo.transform = {8, step, 0, 47, 0, -step};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  return geo;
}

/// A TIN for a plane, as the verb makes it.
Tin mesh_for(const RasterSource& raster, const GeoReference& geo, const MeshPlacement& placement, double max_error) {
  const MeshStore nothing;
  const PlacedMesh plane(nothing, geo, raster.size(), placement);
  TinOptions options;
  options.displacement = plane.displacement();
  return mesh_of(raster, max_error - plane.height_noise_m(), options);
}

// Once refused: the side of a lake had no vertex between its corners, and bent too far.
TEST(MakeTin, LongSidesOfVoidsAreNoHindranceInAnotherPlane) {
  const HeldRaster raster(waves_with_a_lake());
  const GeoReference geo = degrees(1.0 / 1200);
  for (const char* crs : {"EPSG:32632", "EPSG:3857", "EPSG:4978"})
    for (const double bound : {0.5, 5.0, 20.0}) {
      const MeshPlacement placement{crs_wkt(crs), false};
      const Tin tin = mesh_for(raster, geo, placement, bound);
      const PlacedMesh mesh(tin.mesh, geo, raster.size(), placement);
      NoProgress silent;
      MeshCheckOptions options;
      options.max_error_m = bound;
      EXPECT_THAT(faults_of(check_mesh(mesh, mesh.frame(), raster, geo, options, silent), options), IsEmpty()) << crs << ", " << bound;
    }
}

// Once refused: between the border and the void lies half a row of ground, and a triangle reached from its cliff to the void's far corner.
TEST(MakeTin, CliffsBetweenTheBorderAndAVoidAreNoHindranceInAnotherPlane) {
  Raster<float> cells = noisy_waves(120, 40, 0);
  for (std::int64_t x = 20; x < 100; ++x) {
    cells(x, 0) = 720;
    for (std::int64_t y = 1; y < 30; ++y) cells(x, y) = void_value;
  }
  cells(45, 0) = 780;
  const HeldRaster raster(std::move(cells));
  const GeoReference geo = degrees(1.0 / 1200);
  const MeshPlacement placement{"", true};
  for (const double bound : {1.0, 5.0}) {
    const Tin tin = mesh_for(raster, geo, placement, bound);
    const PlacedMesh mesh(tin.mesh, geo, raster.size(), placement);
    NoProgress silent;
    MeshCheckOptions options;
    options.max_error_m = bound;
    EXPECT_THAT(faults_of(check_mesh(mesh, mesh.frame(), raster, geo, options, silent), options), IsEmpty()) << bound;
  }
}

TEST(MakeTin, AnyRasterKeepsAnyBoundInAnyPlane) {
  const MeshPlacement placements[] = {{"", true}, {crs_wkt("EPSG:3857"), false}, {crs_wkt("EPSG:4978"), false}};
  int meshed = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    const HeldRaster raster(random_raster(seed));
    GeoReference geo = degrees(std::pow(10.0, -5 + 2.5 * random_share(seed, 1, 0)));
    (*geo.transform)[0] = random_share(seed, 2, 0) * 300 - 150;
    (*geo.transform)[3] = random_share(seed, 3, 0) * 140 - 65;
    const MeshPlacement& placement = placements[seed % 3];
    const double bound = std::pow(10.0, random_share(seed, 4, 0) * 5 - 2);
    NoProgress silent;
    try {
      const Tin tin = mesh_for(raster, geo, placement, bound);
      const PlacedMesh mesh(tin.mesh, geo, raster.size(), placement);
      MeshCheckOptions options;
      options.max_error_m = bound;
      EXPECT_THAT(faults_of(check_mesh(mesh, mesh.frame(), raster, geo, options, silent), options), IsEmpty()) << "seed " << seed << ", bound " << bound;
      ++meshed;
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::format || std::string(error.what()).find("no valid cell") != std::string::npos) << seed << ": " << error.what();
    }
  }
  EXPECT_GT(meshed, 500);
}

// Once refused: the sides were as long as the sea beside them is flat, and too long for the cliffs two cells further.
TEST(MakeTin, CliffsBesideAFlatBorderAreNoHindranceInAnotherPlane) {
  Raster<float> cells(300, 250, 0.0f);
  for (std::int64_t y = 2; y < 249; ++y)
    for (std::int64_t x = 1; x < 299; ++x) cells(x, y) = static_cast<float>(800 + 400 * std::sin(static_cast<double>(x) / 6) * std::cos(static_cast<double>(y) / 5));
  const HeldRaster raster(std::move(cells));
  const GeoReference geo = degrees(1.0 / 1200);
  for (const char* crs : {"EPSG:32632", "EPSG:4978"}) {
    const MeshPlacement placement{crs_wkt(crs), false};
    const Tin tin = mesh_for(raster, geo, placement, 2);
    const PlacedMesh mesh(tin.mesh, geo, raster.size(), placement);
    NoProgress silent;
    MeshCheckOptions options;
    options.max_error_m = 2;
    EXPECT_THAT(faults_of(check_mesh(mesh, mesh.frame(), raster, geo, options, silent), options), IsEmpty()) << crs;
  }
}

TEST(MakeTin, SidesOfVoidsAreNoLongerThanAllowed) {
  Raster<float> cells(200, 150, 5.0f);
  for (std::int64_t y = 40; y < 110; ++y)
    for (std::int64_t x = 0; x < 120; ++x) cells(x, y) = void_value;
  const HeldRaster raster(std::move(cells));
  TinOptions options;
  options.displacement.longest_cells = 12;
  const Tin tin = mesh_of(raster, 1, options);
  EXPECT_THAT(faults(tin, raster, 1), IsEmpty());
  const std::vector<MeshVertex> vertices = vertices_of(tin.mesh);
  for (const MeshTriangle& t : triangles_of(tin.mesh))
    for (std::size_t k = 0; k < 3; ++k) {
      const MeshVertex &a = vertices[static_cast<std::size_t>(t[k])], &b = vertices[static_cast<std::size_t>(t[(k + 1) % 3])];
      EXPECT_LE(std::hypot(a.x - b.x, a.y - b.y), 12);
    }
}

struct RealDem {
  const char* name;
  std::vector<double> bounds;
};
void PrintTo(const RealDem& dem, std::ostream* out) { *out << dem.name; }

class MakeTinOfRealDem : public testing::TestWithParam<RealDem> {};

TEST_P(MakeTinOfRealDem, KeepsEveryBound) {
  const std::string path = test_data(GetParam().name);
  if (path.empty()) GTEST_SKIP() << "set ARETE_TEST_DATA to the folder of the development data";
  const DemReader dem(path);
  for (const double bound : GetParam().bounds) {
    const Tin tin = mesh_of(dem, bound);
    EXPECT_THAT(faults(tin, dem, bound, dem.georeference()), IsEmpty()) << bound;
    // Small meshes are mostly border; where the bound needs nearly every cell there is little to take away.
    if (bound == GetParam().bounds[2] && tin.report.triangles > 1000 && tin.report.triangles < tin.report.full_triangles / 2) {
      const Tin greedy = mesh_of(dem, bound, with_passes(0));
      EXPECT_LT(static_cast<double>(tin.report.triangles), 0.8 * static_cast<double>(greedy.report.triangles)) << bound;
    }
  }
}

// Seven bounds each, of integers and floats, with voids and without; coarse where there are many cells, so that all takes less than a minute.
INSTANTIATE_TEST_SUITE_P(
    , MakeTinOfRealDem,
    testing::Values(RealDem{"davos_srtm1_1arcsec.tif", {20, 30, 40, 50, 70, 100, 200}}, RealDem{"n46e008_srtm3_3arcsec_voids.tif", {20, 30, 40, 50, 70, 100, 200}},
                    RealDem{"aleutians_glo30_1arcsec_ocean.tif", {5, 7, 10, 15, 20, 30, 50}}, RealDem{"davosdorf_dtm_10m.tif", {0.5, 1, 2, 5, 10, 20, 30}},
                    RealDem{"alr_tyrol_dtm_5m.tif", {0.5, 1, 2, 3, 5, 10, 20}}, RealDem{"hit_tyrol_dtm_5m.asc", {0.5, 1, 2, 3, 5, 10, 20}},
                    RealDem{"greenriver_lidar_1m.tif", {0.25, 0.5, 0.75, 1, 2, 5, 10}}, RealDem{"gabilan_lidar_1m.bil", {0.1, 0.25, 0.5, 1, 2, 5, 10}},
                    RealDem{"inyo_srtm_30m_utm11_nan.tif", {1, 2, 5, 10, 20, 30, 50}}, RealDem{"recife_srtm1_1arcsec_coast.tif", {0.5, 1, 1.5, 2, 3, 5, 10}},
                    RealDem{"edge-cases/geographic_anisotropic_74x92.tif", {0.001, 0.1, 1, 5, 20, 100, 10000}},
                    RealDem{"edge-cases/n31e035_srtm3_below_sea_level.tif", {10, 15, 20, 30, 50, 70, 100}},
                    RealDem{"edge-cases/no_crs_6x4.tif", {0.001, 0.1, 0.5, 1, 2, 5, 1000}}),
    [](const auto& real) {
      const std::string path = real.param.name;
      const std::string name = path.substr(path.find('/') + 1);
      return name.substr(0, name.find('_'));
    });

TEST(MakeTin, AnEmptyDemHasNothingToMesh) {
  const std::string path = test_data("edge-cases/all_nodata_74x92.tif");
  if (path.empty()) GTEST_SKIP() << "set ARETE_TEST_DATA to the folder of the development data";
  EXPECT_THROW(mesh_of(DemReader(path), 1), Error);
}

}  // namespace
}  // namespace arete
