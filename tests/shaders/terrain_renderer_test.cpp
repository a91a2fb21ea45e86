#include "shaders/terrain_renderer.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <map>
#include <set>
#include <vector>

#include "core/support/error.h"
#include "gis/dem_file.h"
#include "tests/data.h"
#include "tests/shaders/count_holes.h"
#include "tests/shaders/gl_fixture.h"
#include "tests/shaders/source_with_levels.h"

namespace arete {
namespace {

using TerrainRendererTest = GlFixture;

/// Sides of ground triangles that an odd number of triangles have, and that are not on the border of the terrain: at a crack the
/// sides of one patch are not those of its neighbour.
std::int64_t count_open_sides(TerrainRenderer& renderer, std::vector<TerrainPatch> patches, Size size) {
  std::erase_if(patches, [](const TerrainPatch& patch) { return patch.side != 0; });
  const auto vertices = renderer.evaluate(patches);
  using Corner = std::array<float, 3>;
  std::map<std::pair<Corner, Corner>, int> sides;
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      Corner a = vertices[i + k], b = vertices[i + (k + 1) % 3];
      if (a == b) continue;
      if (b < a) std::swap(a, b);
      ++sides[{a, b}];
    }
  const auto right = static_cast<float>(size.width - 1), bottom = static_cast<float>(size.height - 1);
  return std::count_if(sides.begin(), sides.end(), [&](const auto& side) {
    const auto& [a, b] = side.first;
    const bool border = (a[0] == b[0] && (a[0] == 0 || a[0] == right)) || (a[1] == b[1] && (a[1] == 0 || a[1] == bottom));
    return side.second % 2 == 1 && !border;
  });
}

/// Levels per patch, without regard to the neighbours.
std::vector<TerrainPatch> crack(std::vector<TerrainPatch> patches) {
  for (TerrainPatch& patch : patches) {
    const int level = patch.side == 0 && (patch.x + patch.y) / (node_cells << patch.level) % 2 == 0 ? 2 : 8;
    patch.outer = {level, level, level, level};
    patch.inner = {level, level};
  }
  return patches;
}

TEST_F(TerrainRendererTest, EveryVertexIsASampleOfTheDem) {
  const Raster<float> cells = synthesize_mountains({333, 270}, {.seed = 3});
  const ViewSource source(cells.view());
  const auto renderer = render(source, {});
  for (const double share : {0.0, 0.3, 2.0}) {
    const Camera camera = frame_box(renderer->box(), 200, 35, 30, 1.5, share * 10000);
    const auto vertices = renderer->evaluate(renderer->select(camera, {600, 400}));
    ASSERT_GT(vertices.size(), 1000u);
    for (const auto& v : vertices) {
      const auto x = static_cast<std::int64_t>(v[0]), y = static_cast<std::int64_t>(v[1]);
      ASSERT_TRUE(x >= 0 && y >= 0 && x < 333 && y < 270 && static_cast<float>(x) == v[0] && static_cast<float>(y) == v[1]);
      ASSERT_EQ(v[2], cells(x, y)) << x << ", " << y;
    }
  }
}

TEST_F(TerrainRendererTest, TheTessellatorMakesAsManyTrianglesAsCounted) {
  const Raster<float> cells = synthesize_mountains({300, 300}, {.seed = 4});
  const ViewSource source(cells.view());
  const auto renderer = render(source, {});
  const std::vector<std::array<int, 6>> cases = {{1, 1, 1, 1, 1, 1}, {16, 16, 16, 16, 16, 16}, {2, 1, 1, 1, 1, 1}, {4, 8, 16, 2, 8, 8}, {1, 4, 1, 4, 4, 1}, {8, 8, 16, 8, 1, 1}};
  for (const std::array<int, 6>& levels : cases) {
    const TerrainPatch patch{64, 64, 0, {levels[0], levels[1], levels[2], levels[3]}, {levels[4], levels[5]}, 0};
    const auto vertices = renderer->evaluate({patch});
    // Every triangle was written: none is left of zeros at the end.
    ASSERT_EQ(vertices.size(), static_cast<std::size_t>(3 * count_triangles(patch)));
    EXPECT_TRUE(vertices.back()[0] >= 64 && vertices.back()[1] >= 64);
    double area = 0;
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
      const auto &a = vertices[i], &b = vertices[i + 1], &c = vertices[i + 2];
      area += std::abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2;
    }
    EXPECT_DOUBLE_EQ(area, 16 * 16);
  }
}

TEST_F(TerrainRendererTest, PatchesMeetWithoutCracks) {
  const Size size{700, 531};
  const Raster<float> cells = synthesize_mountains(size, {.seed = 5});
  const ViewSource source(cells.view());
  const auto renderer = render(source, {});
  std::set<std::int32_t> levels;
  for (const double distance : {1500.0, 4000.0, 10000.0, 30000.0}) {
    // A field of view that sees all of the ground, so that every edge has its neighbour.
    const Camera camera = orbit_camera({10000, -8000, 1000}, 230, 90, distance, 170);
    const auto patches = renderer->select(camera, {1000, 1000});
    for (const TerrainPatch& patch : patches) levels.insert(patch.level);
    ASSERT_GT(patches.size(), 4u);
    EXPECT_EQ(count_open_sides(*renderer, patches, size), 0) << distance;
    EXPECT_GT(count_open_sides(*renderer, crack(patches), size), 50) << distance;
  }
  EXPECT_GE(levels.size(), 2u);
}

TEST_F(TerrainRendererTest, LevelsOfTheSourceAreReadWhereTheyAreSeen) {
  const Size size{1500, 1100};
  const SourceWithLevels source(synthesize_mountains(size, {.seed = 15}), 6);
  SceneOptions options;
  options.measured_cells = 30000;  // level 3, of 188 x 138 cells
  const auto renderer = render(source, options);
  EXPECT_EQ(source.reads[0] + source.reads[1] + source.reads[2], 0);
  // From afar nothing finer is needed.
  renderer->draw(orbit_camera({22000, -16000, 1000}, 200, 40, 400000, 30), {300, 200});
  EXPECT_EQ(source.reads[0] + source.reads[1] + source.reads[2], 0);
  // Close by some of the finest, but not all.
  const Camera close = orbit_camera({22000, -16000, 1000}, 200, 50, 3000, 40);
  renderer->draw(close, {600, 400});
  EXPECT_GT(source.reads[0], 1000);
  EXPECT_LT(source.reads[0], size.cells() / 4);
  // Every vertex is a sample of the level that it is drawn from, or of the next coarser one at the side it shares with it.
  const Camera wide = orbit_camera({22000, -16000, 1000}, 230, 90, 2500, 170);
  const auto patches = renderer->select(wide, {250, 250});
  const auto vertices = renderer->evaluate(patches);
  std::size_t next = 0;
  std::set<std::int32_t> levels;
  std::int64_t shared = 0;
  for (const TerrainPatch& patch : patches) {
    if (patch.side == 0 && patch.level < 3) levels.insert(patch.level);
    const std::size_t first = next;
    next += static_cast<std::size_t>(3 * count_triangles(patch));
    // At the border levels end where they have a cell.
    if (patch.side != 0 || patch.x > 1300 || patch.y > 900) continue;
    for (std::size_t i = first; i < next; ++i) {
      const auto& v = vertices[i];
      const auto x = static_cast<std::int64_t>(v[0]), y = static_cast<std::int64_t>(v[1]);
      const int level = std::min(patch.level, 3);
      const bool own = v[2] == source.height(level, x >> level, y >> level);
      const bool above = patch.from_above != 0 && v[2] == source.height(level + 1, x >> (level + 1), y >> (level + 1));
      ASSERT_TRUE(own || above) << patch.level << ": " << x << ", " << y << ", " << v[2];
      shared += above;
    }
  }
  EXPECT_EQ(levels.size(), 3u);
  EXPECT_GT(shared, 100);
  EXPECT_EQ(count_open_sides(*renderer, patches, size), 0);
  std::vector<TerrainPatch> apart = patches;
  for (TerrainPatch& patch : apart) patch.from_above = 0;
  EXPECT_GT(count_open_sides(*renderer, apart, size), 50);
}

TEST_F(TerrainRendererTest, NoPixelShowsThroughFromFiftyCameras) {
  const Raster<float> cells = synthesize_mountains({520, 410}, {.seed = 6});
  const ViewSource source(cells.view());
  const auto renderer = render(source, {});
  const Size picture{320, 240};
  std::int64_t cracked = 0;
  for (int i = 0; i < 50; ++i) {
    const Camera from = camera(*renderer, i);
    const auto patches = renderer->select(from, picture);
    EXPECT_EQ(count_holes(renderer->draw(patches, from, picture, DrawMode::coverage)), 0) << "camera " << i;
    cracked += count_holes(renderer->draw(crack(patches), from, picture, DrawMode::coverage)) > 0;
  }
  EXPECT_GE(cracked, 40);  // the detector sees what it is to see
}

TEST_F(TerrainRendererTest, TheSameBytesWhateverWasDrawnBefore) {
  const Raster<float> cells = synthesize_mountains({600, 600}, {.seed = 7});
  const ViewSource source(cells.view());
  SceneOptions options;
  options.threads = 1;
  const auto one = render(source, options);
  options.threads = 3;
  options.memory_bytes = 2 << 20;  // few tiles at a time, and few levels in memory
  const auto small = render(source, options);
  const Size picture{320, 200};
  const Frame first = one->draw(camera(*one, 3), picture);
  for (int i = 0; i < 5; ++i) one->draw(camera(*one, i), picture);
  EXPECT_EQ(one->draw(camera(*one, 3), picture).rgba, first.rgba);
  small->draw(camera(*one, 8), picture);
  const Frame again = small->draw(camera(*one, 3), picture);
  EXPECT_TRUE(again.rgba == first.rgba);
}

TEST_F(TerrainRendererTest, APictureInPartsIsOnePicture) {
  const Raster<float> cells = synthesize_mountains({400, 400}, {.seed = 8});
  const ViewSource source(cells.view());
  const auto renderer = render(source, {});
  const Size picture{1400, 300};
  const Frame frame = renderer->draw(frame_box(renderer->box(), 180, 60, 20, 1400.0 / 300, 9000), picture);
  const auto jump = [&](std::int64_t x) {
    double sum = 0;
    for (std::int64_t y = 0; y < picture.height; ++y) {
      const auto i = static_cast<std::size_t>(4 * (y * picture.width + x));
      sum += std::abs(frame.rgba[i] - frame.rgba[i + 4]);
    }
    return sum / static_cast<double>(picture.height);
  };
  // A part begins at 700; elsewhere pixels beside each other differ as much.
  const double usual = (jump(691) + jump(695) + jump(704) + jump(708)) / 4;
  EXPECT_GT(usual, 0.5);
  EXPECT_LT(jump(699), 1.5 * usual);
}

TEST_F(TerrainRendererTest, RowsAreThePictureFromTopToBottom) {
  const Raster<float> cells = synthesize_mountains({300, 300}, {.seed = 8});
  const ViewSource source(cells.view());
  SceneOptions options;
  options.supersampling = 2;
  const auto renderer = render(source, options);
  const Size picture{150, 1100};
  const Camera from = frame_box(renderer->box(), 180, 60, 60, 150.0 / 1100, 9000);
  const Frame frame = renderer->draw(from, picture);
  std::vector<std::uint8_t> rgba;
  const Frame counts = renderer->draw_rows(from, picture, DrawMode::lit, Highlights::roll_off, [&](const LightRows& rows) {
    ASSERT_EQ(rows.y * picture.width * 4, static_cast<std::int64_t>(rgba.size()));
    ASSERT_EQ(rows.size.width, picture.width);
    EXPECT_LE(rows.size.height, 640);
    rgba.resize(rgba.size() + static_cast<std::size_t>(rows.size.cells() * 4));
    develop(rows, 1, &rgba[static_cast<std::size_t>(rows.y * picture.width * 4)]);
  });
  EXPECT_EQ(rgba, frame.rgba);
  EXPECT_EQ(counts.triangles, frame.triangles);
  EXPECT_TRUE(counts.rgba.empty());
}

TEST_F(TerrainRendererTest, HighlightsRollOffUnlessTheyAreKept) {
  // A slope of snow that faces the sun.
  Raster<float> cells(200, 200);
  for (std::int64_t y = 0; y < 200; ++y)
    for (std::int64_t x = 0; x < 200; ++x) cells(x, y) = static_cast<float>(15 * (x + y));
  const ViewSource source(cells.view());
  SceneOptions options;
  options.ramp = {{250, 250, 250}};
  options.exaggeration = 1;
  options.haze = 0;
  const auto renderer = render(source, options);
  const Camera above = frame_box(renderer->box(), 180, 90, 20, 1, 20000);
  const auto light_in_the_middle = [&](Highlights highlights) {
    float light = 0;
    renderer->draw_rows(above, {64, 64}, DrawMode::lit, highlights, [&](const LightRows& rows) { light = rows.rgba[(32 * 64 + 32) * 4]; });
    return static_cast<double>(light);
  };
  const double kept = light_in_the_middle(Highlights::kept), rolled = light_in_the_middle(Highlights::roll_off);
  EXPECT_GT(kept, 1.05);
  EXPECT_NEAR(rolled, 0.7 + 0.3 * (1 - std::exp(-(kept - 0.7) / 0.3)), 0.002);  // half floats
}

TEST_F(TerrainRendererTest, VoidsAreHolesWithoutSpikes) {
  Raster<float> cells = synthesize_mountains({260, 260}, {.seed = 9});
  float low = cells(0, 0), high = low;
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) low = std::min(low, cells.data()[i]), high = std::max(high, cells.data()[i]);
  for (std::int64_t y = 80; y < 180; ++y)
    for (std::int64_t x = 80; x < 180; ++x) cells(x, y) = void_value;
  const ViewSource source(cells.view());
  SceneOptions options;
  options.exaggeration = 0.001;
  const auto renderer = render(source, options);
  EXPECT_TRUE(renderer->facts().has_voids);
  const Camera above = frame_box(renderer->box(), 180, 90, 20, 1);
  const auto patches = renderer->select(above, {500, 500});
  for (const auto& v : renderer->evaluate(patches)) ASSERT_TRUE(v[2] >= low && v[2] <= high);
  const Frame frame = renderer->draw(patches, above, {500, 500}, DrawMode::coverage);
  std::int64_t covered = 0;
  for (std::size_t i = 0; i < frame.rgba.size(); i += 4) covered += frame.rgba[i] != 0;
  const double all = std::pow(0.96 * 500, 2);
  // Half a cell of each side of the hole is drawn: 100 + 1 - 2/2 cells aside are missing of 259.
  EXPECT_NEAR(static_cast<double>(covered) / all, 1 - 100.0 * 100 / (259.0 * 259), 0.01);
}

TEST_F(TerrainRendererTest, LevelOfDetailTakesUnderAQuarterOfTheFullGrid) {
  const std::string path = test_data("davos_srtm1_1arcsec.tif");
  if (path.empty()) GTEST_SKIP() << "no development data: set ARETE_TEST_DATA";
  const DemReader dem(path);
  const auto renderer = render(dem, {}, dem.cell_size());
  const Size picture{1920, 1080};
  const Camera from = frame_box(renderer->box(), 200, 35, 30, 16.0 / 9);
  std::vector<TerrainPatch> full;
  for (std::int32_t y = 0; y < dem.size().height - 1; y += node_cells)
    for (std::int32_t x = 0; x < dem.size().width - 1; x += node_cells) full.push_back({x, y, 0, {16, 16, 16, 16}, {16, 16}, 0});
  // Seconds of all cores, tiles included.
  const auto time = [&](const std::vector<TerrainPatch>& patches, Frame& frame) {
    const std::clock_t start = std::clock();
    frame = renderer->draw(patches, from, picture, DrawMode::lit);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  Frame all, few;
  const double s = time(renderer->select(from, picture), few), full_s = time(full, all);
  std::printf("%lld of %lld triangles, %.2f of %.2f s\n", static_cast<long long>(few.triangles), static_cast<long long>(all.triangles), s, full_s);
  EXPECT_LT(few.triangles, all.triangles / 4);
}

TEST_F(TerrainRendererTest, RefusesWhatItCannotDraw) {
  const Raster<float> line(5, 1, 3.0f), empty(8, 8, void_value);
  const ViewSource thin(line.view()), nothing(empty.view());
  EXPECT_THROW(render(thin, {}), Error);
  EXPECT_THROW(render(nothing, {}), Error);
  const Raster<float> cells(8, 8, 3.0f);
  const ViewSource flat(cells.view());
  const auto renderer = render(flat, {});
  EXPECT_THROW(renderer->draw(Camera{}, {16385, 10}), Error);
  EXPECT_EQ(renderer->draw(frame_box(renderer->box(), 10, 20, 30, 1), {64, 64}).rgba.size(), 64u * 64 * 4);
}

}  // namespace
}  // namespace arete
