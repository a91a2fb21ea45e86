#pragma once

#include <optional>
#include <string>

#include "gis/dem_file.h"
#include "tools/command.h"
#include "tools/info.h"

namespace arete::tools {

/// The options of `arete verify`, of all kinds of file.
struct VerifyOptions {
  std::string file;
  std::string original;  ///< the DEM that it was made of; empty: not given
  DemReadOptions dem;
  std::optional<double> max_error_m;  ///< the bound that a mesh must keep
  bool clipped = false;               ///< a mesh need not cover all of its DEM
};

/// A tree (.sct): its checksums, and its claim against the DEM. Throws Error{damaged} where it breaks either.
FileReport verify_tree(const VerifyOptions& options, const CommonOptions& common);

/// A mesh: how its triangles hang together, and every cell of the DEM. Throws Error{damaged} where a bound is given and the mesh breaks it
/// or is not sound; without a bound says what it finds.
FileReport verify_mesh(const VerifyOptions& options, const CommonOptions& common);

/// Whether a path is a folder, and so a set of terrain tiles.
bool is_tile_set(const std::string& path);

/// A set of quantized-mesh tiles: every tile by itself and beside its neighbours, and every cell of the DEM. Throws Error{damaged} where
/// it is not sound or breaks the bound.
FileReport verify_tiles(const VerifyOptions& options, const CommonOptions& common);

}  // namespace arete::tools
