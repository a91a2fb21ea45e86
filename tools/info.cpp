#include "tools/info.h"

#include "core/codec/tree_file.h"
#include "core/sparse/dictionary_file.h"
#include "tools/dem_options.h"
#include "tools/mesh_input.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

/// A kind of file that `arete info` knows.
struct FileKind {
  bool (*recognises)(const std::string& path);  ///< by its first bytes, but a mesh by its name; false for what cannot be read
  FileReport (*describe)(const InfoOptions& options, const CommonOptions& common);
  bool has_atoms;
};

bool any_file(const std::string&) { return true; }

/// The first that recognises the file describes it. GDAL is asked last: its own message then says why it cannot be read.
constexpr FileKind file_kinds[] = {
    {is_dictionary_file, describe_dictionary, true},
    {is_tree_file, describe_tree, false},
    {is_mesh_file, describe_mesh, false},
    {any_file, describe_dem, false},
};

void run_info(const InfoOptions& options, const CommonOptions& common) {
  for (const FileKind& kind : file_kinds) {
    if (!kind.recognises(options.file)) continue;
    if (!options.sheet.empty() && !kind.has_atoms)
      throw Error(ErrorKind::usage,
                  "--sheet draws the atoms of a dictionary, '" + options.file + "' is none; see 'arete preview' for DEMs");
    const FileReport report = kind.describe(options, common);
    print_result(common, report.text, report.data);
    return;
  }
}

}  // namespace

void add_info(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* verb =
      add_verb(app, "info", "Say what a file is: a DEM with its cells, CRS and elevations, a dictionary with its atoms, a tree (.sct), or a mesh",
               "arete info dem.tif\narete info --json dem.tif\narete info alps.atoms --sheet atoms.png\narete info mesh.ply", common,
               [=] { run_info(*options, *common); });
  verb->add_option("FILE", options->file, "The file to describe: any DEM that GDAL opens, a dictionary (.atoms), a tree (.sct) or a mesh (.ply...)")->required();
  verb->add_option("--sheet", options->sheet, "Draw the atoms of a dictionary as a contact sheet (.png)");
  add_dem_options(verb, options->dem);
}

}  // namespace arete::tools
