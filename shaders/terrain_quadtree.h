#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/support/progress.h"
#include "shaders/camera.h"
#include "shaders/sample_pyramid.h"

namespace arete {

/// Cells aside of a node of level 0; one of level l covers 2^l times as many, in 16 samples of level l.
inline constexpr int node_cells = 16;
/// A node is drawn with 16, 8, ... 1 segments aside.
inline constexpr int node_steps = 5;

struct QuadtreeNode {
  float low = 0, high = 0;                     ///< of all its samples, metres
  std::array<std::uint8_t, node_steps> error{};  ///< see error_m
  bool any_valid = false;
};

/// Max |DEM - mesh| over the valid samples of a node drawn with 16 >> step segments aside, metres: exact where the mesh is within the node and of
/// squares cut along either diagonal (what edges to coarser or finer neighbours add is not counted), rounded up to steps of 9 %. Rises with `step`.
double error_m(const QuadtreeNode& node, int step);

/// Heights and errors of all nodes.
struct TerrainQuadtree {
  std::vector<Raster<QuadtreeNode>> levels;  ///< of 16 x 16 cells first; the last has one node. Empty below `base`
  Size size;                                 ///< samples
  int base = 0;                              ///< the first level whose nodes were measured
};

/// Nodes of a level along each side.
Size nodes_of(const TerrainQuadtree& tree, int level);
/// Below the base, what its ancestor there is taken to be in parts: errors of spacings that nobody measured fall by 0.7 when the spacing is halved, as ground's do.
QuadtreeNode node_at(const TerrainQuadtree& tree, int level, std::int64_t x, std::int64_t y);

/// Spacings of up to 16 cells are measured against every sample; wider ones are too against the samples of a node's own level, plus the error of
/// these. Reads every sample of the pyramid's base once, by blocks of 1024 x 1024. Memory: 16 bytes per 192 cells, and 10 MB a thread.
TerrainQuadtree build_quadtree(const SamplePyramid& pyramid, int threads, Progress& progress);

/// A quad to be tessellated: a node with segments per side, powers of two from 1 to 16.
struct TerrainPatch {
  std::int32_t x = 0, y = 0, level = 0;         ///< first sample (of the DEM), and level
  std::array<std::int32_t, 4> outer{1, 1, 1, 1};  ///< segments of the west, north, east and south side
  std::array<std::int32_t, 2> inner{1, 1};      ///< segments inside, along columns and rows
  std::int32_t side = 0;                        ///< 0: ground; 1 to 4: the wall under the west, north, east, south side; 5: floor
  std::int32_t from_above = 0;                  ///< bits 0 to 3: the west, north, east, south side, 4 to 7: the north-west, north-east, south-east and
                                                ///< south-west corner have the heights of the next coarser level, as a neighbour there has
  bool operator==(const TerrainPatch&) const = default;
};

/// How a terrain stands in the scene.
struct TerrainPlacement {
  CellSize cell;
  double exaggeration = 1;
  double base = 0;     ///< height of the foot of the walls, exaggerated metres
  bool walls = true;
  bool floor = false;  ///< at the foot of the walls, seen through voids
};

struct SelectionOptions {
  double max_error_px = 2;    ///< error of heights, as steeply as they are seen
  double max_sample_px = 1.5; ///< distance of the samples that slopes are taken from
};

/// The nodes that show the terrain to the camera: split until both limits hold, if seen; then until no two nodes that share an edge or a corner differ
/// by more than one level. The segments of an edge follow from the nodes on both sides - as many as the more demanding one wants,
/// at most what the larger one has - so that both have the same vertices there (guarantee 1: no cracks). Nodes that are not
/// seen or hold no valid sample are left out. Below the base of the tree, whose levels have heights of their own, the side that a node shares with a coarser one has
/// the heights of that. In a fixed order: level, row, column, side.
std::vector<TerrainPatch> select_patches(const TerrainQuadtree& tree, const TerrainPlacement& placement, const Camera& camera, Size picture,
                                         const SelectionOptions& options);

/// Where the node of a patch lies; with walls, down to their foot.
Box patch_box(const TerrainQuadtree& tree, const TerrainPlacement& placement, const TerrainPatch& patch);

/// Triangles that the tessellator makes of a patch (equal spacing, quads; OpenGL 4.5 core, 11.2.2.2).
std::int64_t count_triangles(const TerrainPatch& patch);

}  // namespace arete
