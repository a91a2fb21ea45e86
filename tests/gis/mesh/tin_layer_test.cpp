#include "gis/mesh/tin_layer.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "gis/crs.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/hill_mesh.h"

namespace arete {
namespace {

struct Format {
  const char* name;
  void (*write)(const MeshSource&, const MeshFrame&, const std::string&, const MeshWriteOptions&);
  MeshFile (*read)(const std::string&, const Scratch&);
};

const Format formats[] = {{"mesh.gpkg", write_geopackage, read_geopackage}, {"mesh.fgb", write_flatgeobuf, read_flatgeobuf}};

struct Place {
  const char* crs;
  double x, y, spacing;
  const char* unit;
  double metres;
};

const Place places[] = {{"EPSG:32632+5773", 412345.678, 5212345.678, 500, "m", 1},
                        {"EPSG:3857", 12958095.124, 4865499.469, 500, "m", 1},
                        {"EPSG:4979", 7.1, 46.2, 0.003, "m", 1},
                        {"EPSG:2227", 6e6, 2e6, 100, "ft", 0.3048},
                        {"", 0, 0, 1, "m", 1}};

TEST(TinLayer, ComesBackBitForBit) {
  for (const Format& format : formats)
    for (const Place& place : places) {
      SCOPED_TRACE(std::string(format.name) + " " + place.crs);
      const TestFolder folder;
      const MeshStore mesh = hill_mesh(60, 40, place.x, place.y, place.spacing);
      const MeshFrame frame{place.crs[0] == '\0' ? "" : crs_wkt(place.crs), place.unit, place.metres};
      format.write(mesh, frame, folder / format.name, {});
      const MeshFile file = format.read(folder / format.name, {});
      EXPECT_EQ(file.mesh.vertices(), mesh.vertices());
      EXPECT_EQ(sorted_corners(file.mesh), sorted_corners(mesh));
      EXPECT_EQ(file.frame.vertical_unit, frame.vertical_unit);
      EXPECT_EQ(file.frame.metres_per_unit, frame.metres_per_unit);
      EXPECT_EQ(summarise_crs(file.frame.crs_wkt).authority, summarise_crs(frame.crs_wkt).authority);
      EXPECT_EQ(summarise_crs(file.frame.crs_wkt).vertical_authority, summarise_crs(frame.crs_wkt).vertical_authority);
      EXPECT_EQ(folder.names(), (std::vector<std::string>{format.name}));
    }
}

TEST(TinLayer, ComesBackBitForBitInGeocentricCoordinates) {
  for (const Format& format : formats) {
    SCOPED_TRACE(format.name);
    const TestFolder folder;
    MeshStore mesh;  // seen from the south the triangle turns the other way in X and Y
    mesh.append_vertices(std::vector<MeshVertex>{{4e6, 1e6 + 0.1, -4.8e6}, {4e6 + 7.3, 1e6, -4.8e6}, {4e6, 1e6 + 9.7, -4.8e6 + 0.3}});
    mesh.append_triangles(std::vector<MeshTriangle>{{0, 2, 1}});
    format.write(mesh, {crs_wkt("EPSG:4978"), "m", 1}, folder / format.name, {});
    EXPECT_EQ(sorted_corners(format.read(folder / format.name, {}).mesh), sorted_corners(mesh));
  }
}

// As any program that uses GDAL sees it.
TEST(TinLayer, OgrFindsBlocksOfTenThousandTriangles) {
  for (const Format& format : formats) {
    SCOPED_TRACE(format.name);
    const TestFolder folder;
    const MeshStore mesh = hill_mesh(120, 100, 412345.678, 5212345.678, 30);  // 23,562 triangles
    format.write(mesh, {crs_wkt("EPSG:32632+5773"), "m", 1}, folder / format.name, {});
    const GDALDatasetUniquePtr dataset(GDALDataset::Open((folder / format.name).c_str(), GDAL_OF_VECTOR));
    ASSERT_NE(dataset, nullptr);
    ASSERT_EQ(dataset->GetLayerCount(), 1);
    OGRLayer& layer = *dataset->GetLayer(0);
    EXPECT_EQ(layer.GetGeomType(), wkbTINZ);
    EXPECT_EQ(layer.GetFeatureCount(), 3);
    ASSERT_NE(layer.GetSpatialRef(), nullptr);
    EXPECT_TRUE(layer.GetSpatialRef()->IsCompound());
    EXPECT_TRUE(layer.TestCapability(OLCFastSpatialFilter));
    GIntBig triangles = 0;
    for (const auto& feature : layer) {
      triangles += feature->GetFieldAsInteger64("triangles");
      ASSERT_EQ(wkbFlatten(feature->GetGeometryRef()->getGeometryType()), wkbTIN);
      EXPECT_LT(feature->GetFieldAsDouble("z_low"), 310);
      EXPECT_GT(feature->GetFieldAsDouble("z_high"), 1090);
    }
    EXPECT_EQ(triangles, mesh.triangles());
  }
}

TEST(TinLayer, TheSameMeshGivesTheSameBytes) {
  const MeshStore mesh = hill_mesh(20, 20, 0, 0, 1);
  for (const Format& format : formats) {
    SCOPED_TRACE(format.name);
    const TestFolder one, two;
    for (const TestFolder* folder : {&one, &two}) format.write(mesh, {crs_wkt("EPSG:32632"), "m", 1}, *folder / format.name, {});
    EXPECT_EQ(read_file(one / format.name), read_file(two / format.name));
  }
}

void make_layer(const std::string& path, OGRwkbGeometryType type, const char* wkt) {
  GDALAllRegister();
  const GDALDatasetUniquePtr dataset(GetGDALDriverManager()->GetDriverByName("GPKG")->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = dataset->CreateLayer("other", nullptr, type);
  OGRGeometry* geometry = nullptr;
  ASSERT_EQ(OGRGeometryFactory::createFromWkt(wkt, nullptr, &geometry), OGRERR_NONE);
  OGRFeature feature(layer->GetLayerDefn());
  feature.SetGeometryDirectly(geometry);
  ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
}

TEST(TinLayer, ReadsPolygonsOfThreeCornersAndTurnsThem) {
  const TestFolder folder;
  make_layer(folder / "a.gpkg", wkbMultiPolygon25D, "MULTIPOLYGON Z (((0 0 1,0 1 2,1 0 3,0 0 1)),((1 0 3,0 1 2,1 1 4,1 0 3)))");
  const MeshFile file = read_geopackage(folder / "a.gpkg");
  EXPECT_EQ(vertices_of(file.mesh).size(), 4u);
  EXPECT_EQ(sorted_corners(file.mesh), sorted({{0, 0, 1, 1, 0, 3, 0, 1, 2}, {1, 0, 3, 1, 1, 4, 0, 1, 2}}));
}

TEST(TinLayer, RefusesWhatIsNoMesh) {
  const TestFolder folder;
  make_layer(folder / "square.gpkg", wkbPolygon, "POLYGON ((0 0,1 0,1 1,0 1,0 0))");
  make_layer(folder / "line.gpkg", wkbLineString, "LINESTRING (0 0,1 0,1 1)");
  for (const char* name : {"square.gpkg", "line.gpkg"}) {
    try {
      read_geopackage(folder / name);
      FAIL() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::format);
    }
  }
  EXPECT_THROW(read_flatgeobuf(folder / "line.gpkg"), Error);
  EXPECT_THROW(read_geopackage(folder / "missing.gpkg"), Error);
}

TEST(TinLayer, SurvivesDamage) {
  for (const Format& format : formats) {
    SCOPED_TRACE(format.name);
    const TestFolder folder;
    format.write(hill_mesh(5, 4, 412345.678, 5212345.678, 30), {crs_wkt("EPSG:32632"), "m", 1}, folder / format.name, {});
    // A GeoPackage has 100 kB, and SQLite takes a millisecond to open one.
    const std::size_t step = std::string(format.name) == "mesh.gpkg" ? 397 : 5;
    EXPECT_GT(read_damaged(folder / format.name, folder / (std::string("bad-") + format.name), step, [&](const std::string& path) { return format.read(path, {}).mesh; }), 50);
  }
}

}  // namespace
}  // namespace arete
