#include "gis/tin/placed_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "core/support/random.h"
#include "gis/crs.h"
#include "gis/mesh/mesh_store.h"
#include "gis/mesh/raster_plane.h"
#include "gis/tin/make_tin.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

MeshStore one_triangle() {
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{0, 0, 100}, {99, 0, 110}, {0, 49.5, 120}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 2, 1}});  // counter-clockwise where rows run south
  return mesh;
}

GeoReference utm() {
  GeoReference geo;
  geo.transform = {450000, 30, 0, 5200000, 0, -30};
  geo.crs_wkt = crs_wkt("EPSG:32632");
  return geo;
}

std::vector<MeshVertex> vertices_of(const MeshSource& mesh) {
  std::vector<MeshVertex> vertices(static_cast<std::size_t>(mesh.vertices()));
  mesh.read_vertices(0, vertices);
  return vertices;
}

/// Twice the signed area in x and y of the first triangle.
double turn(const MeshSource& mesh) {
  std::vector<MeshTriangle> t(1);
  mesh.read_triangles(0, t);
  const std::vector<MeshVertex> v = vertices_of(mesh);
  const MeshVertex &a = v[static_cast<std::size_t>(t[0][0])], &b = v[static_cast<std::size_t>(t[0][1])], &c = v[static_cast<std::size_t>(t[0][2])];
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

constexpr Size size{100, 80};

TEST(PlacedMesh, LiesAtTheCentresOfCells) {
  const MeshStore mesh = one_triangle();
  const PlacedMesh placed(mesh, utm(), size, {});
  const std::vector<MeshVertex> v = vertices_of(placed);
  EXPECT_EQ(v[0], (MeshVertex{450015, 5199985, 100}));
  EXPECT_EQ(v[2], (MeshVertex{450015, 5198500, 120}));
  EXPECT_GT(turn(placed), 0);
  EXPECT_EQ(placed.frame().crs_wkt, utm().crs_wkt);
  EXPECT_EQ(placed.cell_units(), 30);
  EXPECT_FALSE(placed.displacement().any());
}

TEST(PlacedMesh, WithoutTransformRowsRunDown) {
  const MeshStore mesh = one_triangle();
  const std::vector<MeshVertex> v = vertices_of(PlacedMesh(mesh, {}, size, {}));
  EXPECT_EQ(v[1], (MeshVertex{99.5, -0.5, 110}));
}

TEST(PlacedMesh, FacesTheSkyInAMirroredRaster) {
  const MeshStore mesh = one_triangle();
  GeoReference geo = utm();
  geo.transform = {450000, 30, 0, 5200000, 0, 30};
  EXPECT_GT(turn(PlacedMesh(mesh, geo, size, {})), 0);
}

TEST(PlacedMesh, FeetStayFeet) {
  const MeshStore mesh = one_triangle();
  GeoReference geo = utm();
  geo.vertical_unit = "ft";
  geo.metres_per_unit = 0.3048;
  EXPECT_DOUBLE_EQ(vertices_of(PlacedMesh(mesh, geo, size, {}))[0].z, 100 / 0.3048);
  const PlacedMesh metric(mesh, geo, size, {"", true});
  EXPECT_EQ(vertices_of(metric)[0].z, 100);
  EXPECT_EQ(metric.frame().metres_per_unit, 1);
}

TEST(PlacedMesh, DegreesBecomeTheirUtmZoneForMetricFormats) {
  const MeshStore mesh = one_triangle();
  GeoReference geo;
  geo.transform = {-35.0, 1.0 / 3600, 0, -8.0, 0, -1.0 / 3600};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  const PlacedMesh placed(mesh, geo, size, {"", true});
  EXPECT_EQ(summarise_crs(placed.frame().crs_wkt).authority, "EPSG:32725");
  EXPECT_NEAR(placed.cell_units(), 30.7, 0.3);
  EXPECT_GT(turn(placed), 0);
  const Displacement moved = placed.displacement();
  EXPECT_GT(moved.bend_cells, 0);
  EXPECT_LT(moved.bend_cells * moved.longest_cells * moved.longest_cells, 0.2501);
}

TEST(PlacedMesh, UtmIsTheZoneThatTheRasterLiesInUnlessItIsInOne) {
  const MeshStore mesh = one_triangle();
  const auto crs_of = [&](const char* own, double x, double y) {
    GeoReference geo;
    geo.transform = {x, 10, 0, y, 0, -10};
    geo.crs_wkt = crs_wkt(own);
    return summarise_crs(PlacedMesh(mesh, geo, size, {"", true, true}).frame().crs_wkt).authority;
  };
  EXPECT_EQ(crs_of("EPSG:21781", 780000, 190000), "EPSG:32632");
  EXPECT_EQ(crs_of("EPSG:3857", 1e6, 5.9e6), "EPSG:32632");
  EXPECT_EQ(crs_of("EPSG:6341", 560000, 4300000), "EPSG:6341");
}

TEST(PlacedMesh, GeocentricCoordinatesAreRight) {
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{-0.5, -0.5, 1000}});
  GeoReference geo;
  geo.transform = {90, 0.001, 0, 0, 0, -0.001};  // on the equator: X = 0, Y = a + h
  geo.crs_wkt = crs_wkt("EPSG:4326");
  const PlacedMesh placed(mesh, geo, size, {crs_wkt("EPSG:4978"), false});
  const MeshVertex v = vertices_of(placed)[0];
  EXPECT_NEAR(v.x, 0, 1e-6);
  EXPECT_NEAR(v.y, 6378137 + 1000, 1e-6);
  EXPECT_NEAR(v.z, 0, 1e-6);
  // A chord of L metres sags L² / 8 R below the ellipsoid; a cell is 111 m.
  EXPECT_NEAR(placed.displacement().sag_m, 1.5 * 111.3 * 111.3 / 8 / 6378137, 2e-5);
}

/// Places a thousand vertices over a raster, and takes them back: how far off they come, in metres on the ground.
double round_trip_error(const GeoReference& geo, const MeshPlacement& placement, double cell_m) {
  std::vector<MeshVertex> given;
  for (std::uint64_t i = 0; i < 1000; ++i)
    given.push_back({uniform_at(1, i) * static_cast<double>(size.width - 1), uniform_at(2, i) * static_cast<double>(size.height - 1), uniform_at(3, i) * 4000 - 400});
  MeshStore mesh;
  mesh.append_vertices(given);
  const PlacedMesh placed(mesh, geo, size, placement);
  std::vector<RasterPoint> back(given.size());
  RasterPlane(placed.frame(), geo).place(0, vertices_of(placed), back);
  double worst = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const double column = static_cast<double>(back[i].column) / static_cast<double>(cell_units), row = static_cast<double>(back[i].row) / static_cast<double>(cell_units);
    worst = std::max({worst, cell_m * std::hypot(column - given[i].x, row - given[i].y), std::abs(back[i].z - given[i].z)});
  }
  return worst;
}

TEST(PlacedMesh, ComesBackFromAnyPlaneToAMillimetre) {
  GeoReference geo;
  geo.transform = {9.7, 1.0 / 3600, 0, 46.9, 0, -1.0 / 3600};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  for (const char* crs : {"EPSG:32632", "EPSG:3857", "EPSG:4978", "EPSG:2056", "EPSG:3035"}) EXPECT_LT(round_trip_error(geo, {crs_wkt(crs), false}, 31), 0.001) << crs;
  for (const char* crs : {"EPSG:4326", "EPSG:3857", "EPSG:4978"}) EXPECT_LT(round_trip_error(utm(), {crs_wkt(crs), false}, 30), 0.001) << crs;
  GeoReference feet = utm();
  feet.vertical_unit = "ft";
  feet.metres_per_unit = 0.3048;
  EXPECT_LT(round_trip_error(feet, {}, 30), 0.001);
  for (const std::array<double, 6>& mirrored : {std::array<double, 6>{450000, -30, 0, 5200000, 0, -30}, {450000, 30, 0, 5200000, 0, 30}, {450000, 0, 30, 5200000, 30, 0},
                                                {450000, 20, 10, 5200000, 10, -20}}) {
    GeoReference turned = utm();
    turned.transform = mirrored;
    EXPECT_LT(round_trip_error(turned, {}, 30), 0.001);
    EXPECT_LT(round_trip_error(turned, {crs_wkt("EPSG:3857"), false}, 30), 0.001);
  }
  EXPECT_LT(round_trip_error({}, {}, 1), 0.001);
}

TEST(PlacedMesh, FacesTheSkyHoweverTheRasterIsTurned) {
  const MeshStore mesh = one_triangle();
  for (const std::array<double, 6>& t : {std::array<double, 6>{450000, -30, 0, 5200000, 0, -30}, {450000, -30, 0, 5200000, 0, 30}, {450000, 0, 30, 5200000, 30, 0},
                                         {450000, 0, -30, 5200000, 30, 0}}) {
    GeoReference geo = utm();
    geo.transform = t;
    EXPECT_GT(turn(PlacedMesh(mesh, geo, size, {})), 0);
  }
}

/// The distance of each cell from a mesh along straight edges of another plane, by projecting the centres of the cells there: NaN where no
/// triangle covers it.
Raster<float> errors_in_plane(const Tin& tin, const RasterSource& raster, const GeoReference& geo, const MeshPlacement& placement) {
  const PlacedMesh placed(tin.mesh, geo, raster.size(), placement);
  const auto [width, height] = raster.size();
  MeshStore cells;
  std::vector<MeshVertex> centres;
  Raster<float> heights(width, height);
  raster.read({0, 0, width, height}, heights.view());
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) centres.push_back({static_cast<double>(x), static_cast<double>(y), 0});
  cells.append_vertices(centres);
  const std::vector<MeshVertex> points = vertices_of(PlacedMesh(cells, geo, raster.size(), placement)), corners = vertices_of(placed), own = vertices_of(tin.mesh);
  std::vector<MeshTriangle> triangles(static_cast<std::size_t>(tin.mesh.triangles()));
  placed.read_triangles(0, triangles);
  Raster<float> off(width, height, void_value);
  for (const MeshTriangle& t : triangles) {
    const auto corner = [&](const std::vector<MeshVertex>& of, std::size_t k) { return of[static_cast<std::size_t>(t[k])]; };
    const MeshVertex a = corner(corners, 0), b = corner(corners, 1), c = corner(corners, 2), p = corner(own, 0), q = corner(own, 1), r = corner(own, 2);
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const auto from = [](double u, double v, double w) { return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(std::min({u, v, w}))) - 1); };
    const auto to = [](double u, double v, double w, std::int64_t count) { return std::min(count, static_cast<std::int64_t>(std::ceil(std::max({u, v, w}))) + 2); };
    for (std::int64_t y = from(p.y, q.y, r.y); y < to(p.y, q.y, r.y, height); ++y)
      for (std::int64_t x = from(p.x, q.x, r.x); x < to(p.x, q.x, r.x, width); ++x) {
        const MeshVertex& at = points[static_cast<std::size_t>(y * width + x)];
        const double of_b = ((at.x - a.x) * (c.y - a.y) - (at.y - a.y) * (c.x - a.x)) / area, of_c = ((b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x)) / area;
        if (of_b < -1e-9 || of_c < -1e-9 || of_b + of_c > 1 + 1e-9) continue;
        const auto error = static_cast<float>(std::abs(a.z + of_b * (b.z - a.z) + of_c * (c.z - a.z) - heights(x, y)));
        if (!(error <= off(x, y))) off(x, y) = error;
      }
  }
  return off;
}

TEST(PlacedMesh, TheBoundHoldsAlongTheStraightEdgesOfTheOtherPlane) {
  // Cells of 500 m and more, so that straight edges bend by several cells; a void with long sides.
  Raster<float> waves = noisy_waves(400, 300, 0);
  for (std::int64_t y = 80; y < 200; ++y)
    for (std::int64_t x = 60; x < 330; ++x) waves(x, y) = void_value;
  const HeldRaster raster(std::move(waves));
  GeoReference geo;
  geo.transform = {6, 0.01, 0, 62, 0, -0.01};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  for (const char* crs : {"EPSG:32632", "EPSG:3035"})
    for (const double bound : {5.0, 40.0}) {
      const MeshPlacement placement{crs_wkt(crs), false};
      const MeshStore nothing;
      TinOptions options;
      options.displacement = PlacedMesh(nothing, geo, raster.size(), placement).displacement();
      options.max_error_m = bound;
      NoProgress silent;
      const Raster<float> off = errors_in_plane(make_tin(raster, options, silent), raster, geo, placement);
      for (std::int64_t y = 0; y < 300; ++y)
        for (std::int64_t x = 0; x < 400; ++x) {
          const bool outer = x == 0 || y == 0 || x == 399 || y == 299;
          if (outer && is_void(off(x, y))) continue;  // the border bends past some of the cells on it
          if (is_void(raster.view()(x, y))) {
            EXPECT_TRUE(is_void(off(x, y))) << crs << ": the void at " << x << ", " << y << " is covered";
          } else {
            EXPECT_LE(off(x, y), bound) << crs << ": " << x << ", " << y;
          }
        }
      options.displacement = {};
      const Raster<float> without = errors_in_plane(make_tin(raster, options, silent), raster, geo, placement);
      int beyond = 0;
      for (std::int64_t y = 1; y < 299; ++y)
        for (std::int64_t x = 1; x < 399; ++x) beyond += !is_void(raster.view()(x, y)) && !(without(x, y) <= bound);
      EXPECT_GT(beyond, 0) << "the test sees no bending";
    }
}

TEST(PlacedMesh, RefusesAPlaneThatTheRasterCannotBeIn) {
  const MeshStore mesh = one_triangle();
  EXPECT_THROW(PlacedMesh(mesh, {}, size, {crs_wkt("EPSG:32632"), false}), Error);
}

}  // namespace
}  // namespace arete
