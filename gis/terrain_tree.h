#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/tree/compress.h"
#include "gis/tested_terrain.h"

namespace arete {

/// The terrain of a benchmark as the file that `arete compress` writes: whole metres as 16-bit integers where they fit, else floats.
struct TerrainTree {
  std::vector<std::byte> file;
  CompressionReport report;
};

/// Throws as compress.
TerrainTree encode_tree(const TestedTerrain& terrain, const CompressOptions& options);

/// Elevations in metres into `out`. Throws as ElevationTree, Error{format} where it has another size.
void decode_tree(std::span<const std::byte> file, RasterView<float> out, int threads);

}  // namespace arete
