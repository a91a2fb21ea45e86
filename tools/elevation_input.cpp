#include "tools/elevation_input.h"

#include <utility>

#include <fmt/format.h>

#include "core/support/error.h"
#include "core/tree/elevation_tree.h"
#include "gis/crs.h"
#include "gis/dictionary_search.h"

namespace arete::tools {
namespace {

/// A tree from one of its levels on.
class TreeLevels final : public LevelSource {
 public:
  TreeLevels(ElevationTree tree, int first) : tree_(std::move(tree)), first_(first) {}
  int levels() const override { return tree_.levels() - first_; }
  Size level_size(int level) const override { return tree_.level_size(first_ + level); }
  void read_level(int level, const Window& window, RasterView<float> out) const override { tree_.read_level(first_ + level, window, out); }

 private:
  ElevationTree tree_;
  int first_;
};

}  // namespace

ElevationInput open_elevations(const std::string& path, const DemReadOptions& options, int threads, int level) {
  if (is_tree_file(path)) {
    ElevationTree tree = ElevationTree::open(path, threads, dictionary_finder(path));
    if (level > tree.levels())
      throw Error(ErrorKind::usage, fmt::format("'{}' has levels 0 to {}, --level {} is beyond them", path, tree.levels(), level));
    GeoReference geo = tree.header().geo;
    geo.crs_wkt = expand_crs(geo.crs_wkt);
    for (int l = 0; l < level; ++l) geo = coarsen(geo, 2);
    return {std::make_unique<TreeLevels>(std::move(tree), level), geo};
  }
  if (level > 0) throw Error(ErrorKind::usage, fmt::format("--level is of trees (.sct), '{}' is a DEM: leave it out", path));
  auto dem = std::make_unique<DemReader>(path, options);
  GeoReference geo = dem->georeference();
  return {std::move(dem), geo};
}

}  // namespace arete::tools
