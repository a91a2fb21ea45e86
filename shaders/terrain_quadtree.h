#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/support/progress.h"
#include "shaders/camera.h"
#include "shaders/sample_pyramid.h"

namespace arete {

/// Cells aside of a node of level 0; one of level l covers 2^l times as many, in 64 samples of level l.
inline constexpr int node_cells = 64;
/// A node is drawn with 64, 32, ... 1 segments aside.
inline constexpr int node_steps = 7;

struct QuadtreeNode {
  float low = 0, high = 0;                ///< of all its samples, metres
  std::array<float, node_steps> error{};  ///< estimate of max |DEM - mesh| at the samples, with 64 >> i segments; rises with i
  bool any_valid = false;
};

/// Heights and errors of all nodes, level 0 (64 x 64 cells) first; the last level has one node.
struct TerrainQuadtree {
  std::vector<Raster<QuadtreeNode>> levels;
  Size size;  ///< samples
};

/// Error of spacing 2^k in a quad = what the samples between (of its spacing 2^(k-1)) differ from straight edges and either diagonal,
/// plus the largest error of its four parts. Reads every sample once. Memory: about 40 bytes per 4096 cells and level.
TerrainQuadtree build_quadtree(const SamplePyramid& pyramid, int threads, Progress& progress);

/// A quad to be tessellated: a node with segments per side, powers of two from 1 to 64.
struct TerrainPatch {
  std::int32_t x = 0, y = 0, level = 0;         ///< first sample (of the DEM), and level
  std::array<std::int32_t, 4> outer{1, 1, 1, 1};  ///< segments of the west, north, east and south side
  std::array<std::int32_t, 2> inner{1, 1};      ///< segments inside, along columns and rows
  std::int32_t side = 0;                        ///< 0: ground; 1 to 4: the wall under the west, north, east, south side; 5: floor
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
  double max_error_px = 2;    ///< error of heights, seen from the side
  double max_sample_px = 1.5; ///< distance of the samples that slopes are taken from
};

/// The nodes that show the terrain to the camera: split until both limits hold, if seen; then until no two nodes that share an edge differ
/// by more than one level. The segments of an edge follow from the nodes on both sides - as many as the more demanding one wants,
/// at most what the larger one has - so that both have the same vertices there (guarantee 1: no cracks). Nodes that are not
/// seen or hold no valid sample are left out. In a fixed order: level, row, column, side.
std::vector<TerrainPatch> select_patches(const TerrainQuadtree& tree, const TerrainPlacement& placement, const Camera& camera, Size picture,
                                         const SelectionOptions& options);

/// Where the node of a patch lies; with walls, down to their foot.
Box patch_box(const TerrainQuadtree& tree, const TerrainPlacement& placement, const TerrainPatch& patch);

/// Triangles that the tessellator makes of a patch (equal spacing, quads; OpenGL 4.5 core, 11.2.2.2).
std::int64_t count_triangles(const TerrainPatch& patch);

}  // namespace arete
