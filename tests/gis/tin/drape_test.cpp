#include "gis/tin/drape.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/mesh/mesh_store.h"
#include "tests/gis/tin/tile_rasters.h"

namespace arete {
namespace {

constexpr Size size{100, 80};
constexpr std::int64_t pixels = 3;  // of a picture to a cell
constexpr Colour red{255, 0, 0, 255}, blue{0, 0, 255, 255};
constexpr MeshVertex landmark{70, 20, 0};

GeoReference in_degrees() {
  GeoReference geo;
  geo.transform = {6, 0.02, 0, 62, 0, -0.01};
  geo.crs_wkt = crs_wkt("EPSG:4326");
  return geo;
}

/// Blue, but for the three cells by three about the landmark.
Picture marked_picture() {
  Picture picture(size.width * pixels, size.height * pixels, blue);
  fill(picture, {static_cast<std::int64_t>(landmark.x - 1) * pixels, static_cast<std::int64_t>(landmark.y - 1) * pixels, 3 * pixels, 3 * pixels}, red);
  return picture;
}

/// A mesh of vertices alone, columns and rows.
MeshStore vertices_at(const std::vector<MeshVertex>& places) {
  MeshStore mesh;
  mesh.append_vertices(places);
  return mesh;
}

/// What the writers make of the bounds: the texel under a vertex.
Colour texel(const Drape& drape, const MeshVertex& v) {
  const double across = (v.x - drape.bounds.low.x) / (drape.bounds.high.x - drape.bounds.low.x), down = (drape.bounds.high.y - v.y) / (drape.bounds.high.y - drape.bounds.low.y);
  return drape.picture(static_cast<std::int64_t>(across * static_cast<double>(drape.picture.width())), static_cast<std::int64_t>(down * static_cast<double>(drape.picture.height())));
}

bool is_red(const Colour& c) { return c[0] > 230 && c[2] < 25 && c[3] == 255; }
bool is_blue(const Colour& c) { return c[0] < 25 && c[2] > 230 && c[3] == 255; }

/// Red at the landmark and a cell from it; blue two and more cells from it, and at the corners of the raster.
void expect_marked(const GeoReference& geo, const MeshPlacement& placement) {
  const auto right = static_cast<double>(size.width - 1), bottom = static_cast<double>(size.height - 1);
  const std::vector<MeshVertex> marked{landmark, {landmark.x - 0.9, landmark.y - 0.9, 0}, {landmark.x + 0.9, landmark.y + 0.9, 0}};
  const std::vector<MeshVertex> others{{landmark.x - 2.2, landmark.y, 0}, {landmark.x + 2.2, landmark.y, 0}, {landmark.x, landmark.y - 2.2, 0}, {landmark.x, landmark.y + 2.2, 0},
                                       {0, 0, 0}, {right, 0, 0}, {0, bottom, 0}, {right, bottom, 0}, {landmark.y, landmark.x, 0}};
  const MeshStore in = vertices_at(marked), out = vertices_at(others);
  const PlacedMesh placed_in(in, geo, size, placement), placed_out(out, geo, size, placement);
  const Drape drape = drape_picture(marked_picture(), geo, size, placed_in);
  std::vector<MeshVertex> v(marked.size()), w(others.size());
  placed_in.read_vertices(0, v);
  placed_out.read_vertices(0, w);
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_TRUE(is_red(texel(drape, v[i]))) << "of the marked, number " << i;
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_TRUE(is_blue(texel(drape, w[i]))) << "of the others, number " << i;
}

TEST(DrapePicture, LandmarksAreUnderTheirVertices) {
  expect_marked({}, {});
  expect_marked(in_degrees(), {});
  for (const char* crs : {"EPSG:32632", "EPSG:3857", "EPSG:3035"}) {
    SCOPED_TRACE(crs);
    expect_marked(in_degrees(), {crs_wkt(crs), false});
  }
  expect_marked(in_degrees(), {"", true});
}

TEST(DrapePicture, LandmarksAreUnderTheirVerticesOfTurnedRasters) {
  for (const std::array<double, 6>& turned : {std::array<double, 6>{450000, -30, 0, 5200000, 0, -30}, {450000, 30, 0, 5200000, 0, 30}, {450000, 0, 30, 5200000, 30, 0},
                                              {450000, 20, 10, 5200000, 10, -20}}) {
    GeoReference geo;
    geo.transform = turned;
    geo.crs_wkt = crs_wkt("EPSG:32632");
    expect_marked(geo, {});
  }
}

TEST(DrapePicture, IsAsItWasWhereNorthIsUp) {
  const MeshStore mesh = vertices_at({landmark});
  const PlacedMesh placed(mesh, in_degrees(), size, {});
  const Picture picture = marked_picture();
  const Drape drape = drape_picture(picture, in_degrees(), size, placed);
  EXPECT_EQ(drape.picture.width(), picture.width());
  EXPECT_TRUE(std::equal(picture.data(), picture.data() + picture.width() * picture.height(), drape.picture.data()));
  EXPECT_DOUBLE_EQ(drape.bounds.low.x, 6);
  EXPECT_DOUBLE_EQ(drape.bounds.high.x, 8);
  EXPECT_DOUBLE_EQ(drape.bounds.low.y, 61.2);
  EXPECT_DOUBLE_EQ(drape.bounds.high.y, 62);
}

TEST(DrapePicture, IsTransparentBesideTheRasterAndHiddenColoursStayHidden) {
  Picture picture(size.width, size.height, blue);
  fill(picture, {0, 0, size.width, size.height / 2}, {255, 0, 0, 0});  // red that nobody sees
  const MeshStore mesh = vertices_at({landmark});
  const PlacedMesh placed(mesh, in_degrees(), size, {crs_wkt("EPSG:32632"), false});
  const Drape drape = drape_picture(picture, in_degrees(), size, placed);
  EXPECT_EQ(drape.picture(0, drape.picture.height() - 1)[3], 0);
  std::int64_t seen = 0;
  for (std::int64_t i = 0; i < drape.picture.width() * drape.picture.height(); ++i) {
    const Colour& c = drape.picture.data()[i];
    if (c[3] < 8) continue;  // of so little opacity a colour has few steps
    ++seen;
    EXPECT_LT(c[0], 40);
  }
  EXPECT_GT(seen, size.cells() / 3);
}

TEST(DrawDrape, TheSeaIsBlueUnderItsVertices) {
  Raster<float> cells = noisy_waves(size.width, size.height, 0);
  for (std::int64_t y = 0; y < size.height; ++y)
    for (std::int64_t x = 0; x < 40; ++x) cells(x, y) = 0;
  const HeldRaster raster(std::move(cells));
  NoProgress silent;
  for (const char* crs : {"EPSG:4326", "EPSG:32632"}) {
    const MeshStore mesh = vertices_at({{0, 0, 0}, {37, 5, 0}, {37, 75, 0}, {42, 5, 0}, {42, 75, 0}, {99, 79, 0}});
    const PlacedMesh placed(mesh, in_degrees(), size, {crs_wkt(crs), false});
    const Drape drape = draw_drape(raster, in_degrees(), placed, 1, silent);
    std::vector<MeshVertex> v(6);
    placed.read_vertices(0, v);
    for (std::size_t i = 0; i < 6; ++i) {
      const Colour c = texel(drape, v[i]);
      EXPECT_EQ(c[2] > c[1], i < 3) << crs << ": vertex " << i;  // land is green to white
    }
  }
}

TEST(Drapes, NeedAMapPlane) {
  const MeshStore mesh = vertices_at({landmark});
  const PlacedMesh placed(mesh, in_degrees(), size, {crs_wkt("EPSG:4978"), false});
  const HeldRaster raster(noisy_waves(size.width, size.height, 0));
  NoProgress silent;
  EXPECT_THROW(draw_drape(raster, in_degrees(), placed, 1, silent), Error);
  EXPECT_THROW(drape_picture(marked_picture(), in_degrees(), size, placed), Error);
}

}  // namespace
}  // namespace arete
