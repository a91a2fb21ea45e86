#include <memory>
#include <string>

#include <fmt/format.h>

#include "core/tree/measure.h"
#include "gis/dem_file.h"
#include "gis/dictionary_search.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/stored_dem.h"
#include "tools/tree_report.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct VerifyArguments {
  std::string tree, original;
  DemReadOptions dem;
};

FileReport check_against(const ElevationTree& tree, const VerifyArguments& arguments, const CommonOptions& common) {
  const DemReader dem(arguments.original, arguments.dem);
  const Size size = tree.size();
  if (dem.size() != size)
    throw Error(ErrorKind::input, fmt::format("'{}' has {} x {} cells, the tree '{}' {} x {}: it is of another DEM", arguments.original,
                                              dem.size().width, dem.size().height, arguments.tree, size.width, size.height));
  limit_block_cache(common.memory_bytes / 4);
  const TreeErrors errors = measure_tree(tree, StoredDem(dem), common.memory_bytes / 2, make_progress(common).get());
  FileReport said = describe_errors(arguments.original, arguments.tree, tree.header().type, errors);
  said.data["claim_kept"] = keeps_claim(tree.header(), errors);
  said.data["void_differs"] = errors.void_differs;
  said.text += "claim: " + describe_claim(tree.header()) + "\n";
  if (!keeps_claim(tree.header(), errors))
    throw Error(ErrorKind::damaged, fmt::format("'{}' breaks its claim ({}): RMSE {:.6g} m, largest error {:.6g} m, {} cells differ, {} are void in one only",
                                                arguments.tree, describe_claim(tree.header()), errors.rmse_m, errors.max_error_m, errors.differs,
                                                errors.void_differs));
  said.text += "kept\n";
  return said;
}

void run_verify(const VerifyArguments& arguments, const CommonOptions& common) {
  const ElevationTree tree = ElevationTree::open(arguments.tree, common.threads, dictionary_finder(arguments.tree));
  tree.verify_checksums();
  const std::string sound = fmt::format("{}: all {} nodes agree with their checksums\n", arguments.tree, tree.file().nodes().size());
  FileReport said{sound, {{"file", arguments.tree}, {"nodes", tree.file().nodes().size()}}};
  if (!arguments.original.empty()) {
    const FileReport against = check_against(tree, arguments, common);
    said.text += against.text;
    said.data.update(against.data);
  }
  print_result(common, said.text, said.data);
}

}  // namespace

void add_verify(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* verb = add_verb(app, "verify", "Check a tree (.sct): its checksums, and what it claims against the DEM it was made of",
                            "arete verify dem.sct\narete verify dem.sct --dem dem.tif", common,
                            [arguments, common] { run_verify(*arguments, *common); });
  verb->add_option("TREE", arguments->tree, "The tree (.sct)")->required();
  verb->add_option("--dem", arguments->original, "The DEM that the tree was made of: every cell is compared");
  add_dem_options(verb, arguments->dem);
}

}  // namespace arete::tools
