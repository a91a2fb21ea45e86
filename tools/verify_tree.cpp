#include <fmt/format.h>

#include "core/tree/measure.h"
#include "gis/dem_file.h"
#include "gis/dictionary_search.h"
#include "tools/stored_dem.h"
#include "tools/tree_report.h"
#include "tools/verify.h"

namespace arete::tools {
namespace {

FileReport check_against(const ElevationTree& tree, const VerifyOptions& options, const CommonOptions& common) {
  const DemReader dem(options.original, options.dem);
  const Size size = tree.size();
  if (dem.size() != size)
    throw Error(ErrorKind::input, fmt::format("'{}' has {} x {} cells, the tree '{}' {} x {}: it is of another DEM", options.original,
                                              dem.size().width, dem.size().height, options.file, size.width, size.height));
  limit_block_cache(common.memory_bytes / 4);
  const TreeErrors errors = measure_tree(tree, StoredDem(dem), common.memory_bytes / 2, make_progress(common).get());
  FileReport said = describe_errors(options.original, options.file, tree.header().type, errors);
  said.data["claim_kept"] = keeps_claim(tree.header(), errors);
  said.data["void_differs"] = errors.void_differs;
  said.text += "claim: " + describe_claim(tree.header()) + "\n";
  if (!keeps_claim(tree.header(), errors))
    throw Error(ErrorKind::damaged, fmt::format("'{}' breaks its claim ({}): RMSE {:.6g} m, largest error {:.6g} m, {} cells differ, {} are void in one only",
                                                options.file, describe_claim(tree.header()), errors.rmse_m, errors.max_error_m, errors.differs,
                                                errors.void_differs));
  said.text += "kept\n";
  return said;
}

}  // namespace

FileReport verify_tree(const VerifyOptions& options, const CommonOptions& common) {
  const ElevationTree tree = ElevationTree::open(options.file, common.threads, dictionary_finder(options.file));
  tree.verify_checksums();
  const std::string sound = fmt::format("{}: all {} nodes agree with their checksums\n", options.file, tree.file().nodes().size());
  FileReport said{sound, {{"file", options.file}, {"nodes", tree.file().nodes().size()}}};
  if (!options.original.empty()) {
    const FileReport against = check_against(tree, options, common);
    said.text += against.text;
    said.data.update(against.data);
  }
  return said;
}

}  // namespace arete::tools
