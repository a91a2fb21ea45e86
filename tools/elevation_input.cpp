#include "tools/elevation_input.h"

#include "core/tree/elevation_tree.h"
#include "gis/crs.h"
#include "gis/dictionary_search.h"

namespace arete::tools {

ElevationInput open_elevations(const std::string& path, const DemReadOptions& options, int threads) {
  if (is_tree_file(path)) {
    auto tree = std::make_unique<ElevationTree>(ElevationTree::open(path, threads, dictionary_finder(path)));
    GeoReference geo = tree->header().geo;
    geo.crs_wkt = expand_crs(geo.crs_wkt);
    return {std::move(tree), geo};
  }
  auto dem = std::make_unique<DemReader>(path, options);
  GeoReference geo = dem->georeference();
  return {std::move(dem), geo};
}

}  // namespace arete::tools
