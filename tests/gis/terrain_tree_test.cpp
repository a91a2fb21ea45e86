#include "gis/terrain_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/support/error.h"
#include "core/synthesis/mountains.h"
#include "core/tree/elevation_tree.h"

namespace arete {
namespace {

TestedTerrain mountains(double quantum, double above) {
  Raster<float> cells = synthesize_mountains({60, 50}, {.relief_m = 500});
  for (std::int64_t i = 0; i < cells.size().cells(); ++i) cells.data()[i] = static_cast<float>(std::round((cells.data()[i] + above) / quantum) * quantum);
  return examine_terrain("mountains", std::move(cells));
}

ValueType type_of(const TerrainTree& tree) { return TreeFile(view_bytes(tree.file), "t").header().type; }

TEST(TerrainTree, WholeMetresAreIntegersWhereTheyFit) {
  CompressOptions options;
  options.target = {TreeClaim::lossless, 0};
  EXPECT_EQ(type_of(encode_tree(mountains(1, 0), options)), ValueType::int16);
  EXPECT_EQ(type_of(encode_tree(mountains(1, 40000), options)), ValueType::float32);
  EXPECT_EQ(type_of(encode_tree(mountains(0.01, 0), options)), ValueType::float32);
}

TEST(TerrainTree, DecodesToTheSameMetres) {
  const TestedTerrain terrain = mountains(0.01, 100);
  CompressOptions options;
  options.target = {TreeClaim::lossless, 0};
  const TerrainTree tree = encode_tree(terrain, options);
  Raster<float> decoded(60, 50);
  decode_tree(tree.file, decoded.view(), 1);
  for (std::int64_t i = 0; i < decoded.size().cells(); ++i) ASSERT_EQ(decoded.data()[i], terrain.cells.data()[i]);
  Raster<float> other(60, 51);
  EXPECT_THROW(decode_tree(tree.file, other.view(), 1), Error);
}

}  // namespace
}  // namespace arete
