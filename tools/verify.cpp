#include "tools/verify.h"

#include <memory>

#include "tools/dem_options.h"
#include "tools/mesh_input.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

void run_verify(const VerifyOptions& options, const CommonOptions& common) {
  const bool tiles = is_tile_set(options.file), mesh = tiles || is_mesh_file(options.file);
  if (!mesh && (options.max_error_m || options.clipped))
    throw Error(ErrorKind::usage, "--max-error and --clipped are for meshes; what the tree '" + options.file + "' claims stands in it: leave them out");
  if (mesh && options.original.empty() && (options.max_error_m || options.clipped))
    throw Error(ErrorKind::usage, "--max-error and --clipped compare the mesh '" + options.file + "' with its DEM: give it as --dem");
  if (tiles && options.clipped) throw Error(ErrorKind::usage, "--clipped is for meshes; tiles cover all of their DEM: leave it out");
  const FileReport report = tiles ? verify_tiles(options, common) : mesh ? verify_mesh(options, common) : verify_tree(options, common);
  print_result(common, report.text, report.data);
}

}  // namespace

void add_verify(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App* verb = add_verb(app, "verify", "Check a tree (.sct), a mesh or a folder of terrain tiles, by itself and against the DEM it was made of",
                            "arete verify dem.sct\narete verify dem.sct --dem dem.tif\narete verify mesh.ply --dem dem.tif --max-error 10\narete verify dem.tiles --dem dem.tif --max-error 2", common,
                            [options, common] { run_verify(*options, *common); });
  verb->add_option("FILE", options->file, "A tree (.sct), a mesh (.ply...) or a folder of quantized-mesh tiles")->required();
  verb->add_option("--dem", options->original, "The DEM that it was made of: every cell is compared");
  verb->add_option("--max-error", options->max_error_m, "A mesh must be sound, and at every cell within so many metres; without it errors are only told")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--clipped", options->clipped, "The mesh was clipped by a boundary: it need not cover all of the DEM");
  add_dem_options(verb, options->dem);
}

}  // namespace arete::tools
