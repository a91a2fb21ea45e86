#include "tools/verify.h"

#include <memory>

#include "tools/dem_options.h"
#include "tools/mesh_input.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

void run_verify(const VerifyOptions& options, const CommonOptions& common) {
  const bool mesh = is_mesh_file(options.file);
  if (!mesh && (options.max_error_m || options.clipped))
    throw Error(ErrorKind::usage, "--max-error and --clipped are for meshes; what the tree '" + options.file + "' claims stands in it: leave them out");
  if (mesh && options.original.empty() && (options.max_error_m || options.clipped))
    throw Error(ErrorKind::usage, "--max-error and --clipped compare the mesh '" + options.file + "' with its DEM: give it as --dem");
  const FileReport report = mesh ? verify_mesh(options, common) : verify_tree(options, common);
  print_result(common, report.text, report.data);
}

}  // namespace

void add_verify(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto options = std::make_shared<VerifyOptions>();
  CLI::App* verb = add_verb(app, "verify", "Check a tree (.sct) or a mesh, by itself and against the DEM it was made of",
                            "arete verify dem.sct\narete verify dem.sct --dem dem.tif\narete verify mesh.ply --dem dem.tif --max-error 10", common,
                            [options, common] { run_verify(*options, *common); });
  verb->add_option("FILE", options->file, "A tree (.sct) or a mesh (.ply...)")->required();
  verb->add_option("--dem", options->original, "The DEM that it was made of: every cell is compared");
  verb->add_option("--max-error", options->max_error_m, "A mesh must be sound, and at every cell within so many metres; without it errors are only told")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--clipped", options->clipped, "The mesh was clipped by a boundary: it need not cover all of the DEM");
  add_dem_options(verb, options->dem);
}

}  // namespace arete::tools
