#include "tools/info.h"

#include "tools/dem_options.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

/// A kind of file that `arete info` knows.
struct FileKind {
  bool (*recognises)(const std::string& path);  ///< by its first bytes, not by its name; false for what cannot be read
  Report (*describe)(const InfoOptions& options, const CommonOptions& common);
};

bool any_file(const std::string&) { return true; }

/// The first that recognises the file describes it. GDAL is asked last: its own message then says why it cannot be read.
constexpr FileKind file_kinds[] = {
    {any_file, describe_dem},
};

void run_info(const InfoOptions& options, const CommonOptions& common) {
  for (const FileKind& kind : file_kinds) {
    if (!kind.recognises(options.file)) continue;
    const Report report = kind.describe(options, common);
    print_result(common, report.text, report.data);
    return;
  }
}

}  // namespace

void add_info(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = add_verb(app, "info", "Say what a file is: size, cells, CRS, elevations, how it was made",
                            "arete info dem.tif\narete info --json dem.tif", common, [=] { run_info(*options, *common); });
  verb->add_option("FILE", options->file, "The file to describe: any DEM that GDAL opens")->required();
  add_dem_options(verb, options->dem);
}

}  // namespace arete::tools
