#include "core/amplify/source_map.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/amplify/sample_terrain.h"

namespace arete {
namespace {

constexpr int factor = 2;

/// Patch (i, j) has atom 100 j + i, which comes from exemplar (i + j) % 3.
struct Map {
  explicit Map(int pitch) : grid(make_patch_grid(8, pitch)), exemplar(factor * window.width, factor * window.height), atom(factor * window.width, factor * window.height) {
    coded.columns = patches_touching(grid, window.x, window.x + window.width);
    coded.rows = patches_touching(grid, window.y, window.y + window.height);
    coded.codes.atoms.resize(1, coded.columns.count() * coded.rows.count());
    for (std::int64_t j = coded.rows.begin; j < coded.rows.end; ++j)
      for (std::int64_t i = coded.columns.begin; i < coded.columns.end; ++i)
        coded.codes.atoms(0, coded.index(i, j)) = (i + j) % 7 == 0 ? -1 : static_cast<std::int32_t>(100 * j + i);
    for (std::int32_t a = 0; a < 4000; ++a) sources.push_back({(a / 100 + a % 100) % 3 - (a % 11 == 0 ? 3 : 0), 0, 0, 0});
    for (AtomSource& s : sources)
      if (s.exemplar < -1) s.exemplar = -1;
    coarse = fractal_terrain(window.width, window.height, 1);
    coarse(5, 6) = void_value;
    AmplifiedBands out;
    out.exemplar = exemplar.view();
    out.atom = atom.view();
    map_sources(coded, grid, sources, factor, window, coarse.view(), out);
  }
  Window window{13, 9, 22, 17};
  PatchGrid grid;
  CodedPatches coded;
  std::vector<AtomSource> sources;
  Raster<float> coarse, exemplar, atom;
};

TEST(SourceMap, NamesTheAtomOfThePatchWithTheNearestCentre) {
  for (const int pitch : {2, 4}) {
    const Map map(pitch);
    for (std::int64_t y = 0; y < map.window.height; ++y)
      for (std::int64_t x = 0; x < map.window.width; ++x) {
        if (is_void(map.coarse(x, y))) continue;
        double nearest = INFINITY;
        std::int32_t expected = 0;
        for (std::int64_t j = map.coded.rows.begin; j < map.coded.rows.end; ++j)
          for (std::int64_t i = map.coded.columns.begin; i < map.coded.columns.end; ++i) {
            const double distance = std::hypot(static_cast<double>(patch_origin(map.grid, i)) + 4 - (static_cast<double>(map.window.x + x) + 0.5),
                                               static_cast<double>(patch_origin(map.grid, j)) + 4 - (static_cast<double>(map.window.y + y) + 0.5));
            if (distance < nearest - 1e-9) {
              nearest = distance;
              expected = map.coded.codes.atoms(0, map.coded.index(i, j));
            }
          }
        for (int k = 0; k < factor * factor; ++k) {
          ASSERT_EQ(map.atom(x * factor + k % factor, y * factor + k / factor), static_cast<float>(expected)) << x << ", " << y;
          const float source = map.exemplar(x * factor + k % factor, y * factor + k / factor);
          ASSERT_EQ(source, expected < 0 ? 0.0f : static_cast<float>(map.sources[static_cast<std::size_t>(expected)].exemplar + 1));
        }
      }
  }
}

TEST(SourceMap, VoidCellsAreVoid) {
  const Map map(4);
  for (std::int64_t y = 0; y < map.atom.height(); ++y)
    for (std::int64_t x = 0; x < map.atom.width(); ++x) {
      EXPECT_EQ(is_void(map.atom(x, y)), x / factor == 5 && y / factor == 6);
      EXPECT_EQ(is_void(map.exemplar(x, y)), x / factor == 5 && y / factor == 6);
    }
}

TEST(SourceMap, OneBandAloneMayBeWanted) {
  const Map map(4);
  Raster<float> atom(map.atom.width(), map.atom.height());
  AmplifiedBands out;
  out.atom = atom.view();
  map_sources(map.coded, map.grid, map.sources, factor, map.window, map.coarse.view(), out);
  EXPECT_TRUE(same_bits(atom.view(), map.atom.view()));
}

}  // namespace
}  // namespace arete
