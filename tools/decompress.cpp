#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/tree/elevation_tree.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "gis/dictionary_search.h"
#include "tools/command.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct DecompressArguments {
  std::string input, output, type;
  int level = 0;
  std::vector<std::int64_t> window;
};

Window window_of(const DecompressArguments& arguments, const Size& size) {
  if (arguments.window.empty()) return {0, 0, size.width, size.height};
  const Window window{arguments.window[0], arguments.window[1], arguments.window[2], arguments.window[3]};
  if (window.x < 0 || window.y < 0 || window.width < 1 || window.height < 1 || window.width > size.width - window.x ||
      window.height > size.height - window.y)
    throw Error(ErrorKind::usage, fmt::format("--window {} {} {} {} does not lie in level {} of '{}', which has {} x {} cells", window.x, window.y,
                                              window.width, window.height, arguments.level, arguments.input, size.width, size.height));
  return window;
}

GeoReference georeference_of(const TreeHeader& header, int level, const Window& window) {
  GeoReference geo = header.geo;
  geo.crs_wkt = expand_crs(geo.crs_wkt);
  for (int l = 0; l < level; ++l) geo = coarsen(geo, 2);
  return crop(geo, window);
}

void run_decompress(const DecompressArguments& arguments, const CommonOptions& common) {
  const ElevationTree tree = ElevationTree::open(arguments.input, common.threads, dictionary_finder(arguments.input));
  const TreeHeader& header = tree.header();
  if (arguments.level > tree.levels())
    throw Error(ErrorKind::usage, fmt::format("'{}' has levels 0 to {}, --level {} is beyond them", arguments.input, tree.levels(), arguments.level));
  const Window window = window_of(arguments, tree.level_size(arguments.level));
  DemWriteOptions writing;
  writing.overwrite = common.overwrite;
  writing.threads = common.threads;
  writing.memory_bytes = common.memory_bytes / 4;
  writing.type = arguments.type.empty() ? header.type : *value_type_named(arguments.type);
  writing.scale = header.scale;
  writing.offset = header.offset;
  writing.bands = {header.band_name};
  writing.metadata = header.metadata;
  DemWriter writer(arguments.output, window.size(), georeference_of(header, arguments.level, window), writing);
  const auto progress = make_progress(common);
  progress->begin("decoding", window.size().cells());
  for (const Window& part : split_window(window, common.memory_bytes / 2)) {
    Raster<double> cells(part.width, part.height);
    tree.read_stored(arguments.level, part, cells.view());
    writer.write_stored({part.x - window.x, part.y - window.y, part.width, part.height}, cells.view());
    progress->advance(part.size().cells());
  }
  progress->end();
  writer.commit(progress.get());
  print_result(common, fmt::format("{}: {} x {} cells of {}, level {} of {}\n", arguments.output, window.width, window.height, name_of(writing.type),
                                   arguments.level, arguments.input),
               {{"output", arguments.output}, {"width", window.width}, {"height", window.height}, {"type", std::string(name_of(writing.type))}, {"level", arguments.level}});
}

}  // namespace

void add_decompress(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<DecompressArguments>();
  CLI::App* verb = add_verb(app, "decompress", "Turn a tree (.sct) back into a DEM: all of it or a window, at any level",
                            "arete decompress dem.sct dem.tif\narete decompress dem.sct overview.tif --level 3", common,
                            [arguments, common] { run_decompress(*arguments, *common); });
  verb->add_option("INPUT", arguments->input, "The tree (.sct)")->required();
  verb->add_option("OUTPUT", arguments->output, "The DEM: COG for .tif, else by extension")->required();
  verb->add_option("--level", arguments->level, "0: the raster; each level more halves the cells along each side")->check(CLI::Range(0, 40));
  verb->add_option("--window", arguments->window, "Columns and rows of that level: x y width height")->expected(4);
  verb->add_option("--type", arguments->type, "Type of the stored numbers (default: as in the source)")
      ->check(CLI::IsMember({"Byte", "Int16", "UInt16", "Int32", "UInt32", "Float32", "Float64"}));
}

}  // namespace arete::tools
