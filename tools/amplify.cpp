#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/amplify/amplify.h"
#include "core/sparse/dictionary_file.h"
#include "core/sparse/omp.h"
#include "core/terrain/fill_voids.h"
#include "gis/dem_file.h"
#include "gis/dictionary_search.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/exemplars.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct AmplifyArguments {
  std::string input, output, dictionary, method = "consistent", format;
  std::vector<std::string> exemplars;
  DemReadOptions reading;
  int factor = 4, atoms = 0, sparsity = 1;
  double detail = 1, radius_m = 0;
  bool uncertainty = false, sources = false, fill = false;
};

AmplifyMethod method_of(const std::string& name) { return name == "paper" ? AmplifyMethod::paper : AmplifyMethod::consistent; }

/// The factor of one stage: the smallest root of the whole that stages repeat; 4 before 2, and up to 8 at once.
int stage_factor(int factor) {
  if (factor <= 8) return factor;
  for (const int root : {4, 2, 3, 5, 6, 7}) {
    std::int64_t power = root;
    while (power < factor) power *= root;
    if (power == factor) return root;
  }
  for (int root = 8; root * root <= factor; ++root)
    if (root * root == factor) return root;
  return factor;
}

void check_arguments(const AmplifyArguments& arguments) {
  if (arguments.dictionary.empty() == arguments.exemplars.empty())
    throw Error(ErrorKind::usage, "give either --dict X.atoms or --exemplar DEM...: the landforms that the detail is taken from");
  if (!arguments.dictionary.empty() && (arguments.atoms != 0 || arguments.radius_m != 0))
    throw Error(ErrorKind::usage, "--atoms and --radius belong to learning; a dictionary has its own: leave them out, or give --exemplar");
  if (arguments.uncertainty && arguments.method == "paper")
    throw Error(ErrorKind::usage, "--uncertainty needs --method consistent: the published method has no error model");
}

Dictionary obtain_dictionary(const AmplifyArguments& arguments, const DemReader& dem, const CommonOptions& common, Progress& progress) {
  if (!arguments.dictionary.empty()) return read_dictionary(locate_dictionary(arguments.dictionary));
  LearnSettings settings;
  settings.factor = stage_factor(arguments.factor);
  settings.atoms = arguments.atoms;
  settings.detail = arguments.method == "consistent";
  if (arguments.radius_m > 0) {
    const CellSize cell = dem.cell_size();
    settings.patch_cells = patch_of_radius(arguments.radius_m, std::sqrt(cell.x_m * cell.y_m));
  }
  return learn_from_files(arguments.exemplars, settings, 0, common, progress).dictionary;
}

std::map<std::string, std::string> describe_making(const AmplifyArguments& arguments, const Dictionary& dictionary, const CommonOptions& common) {
  char detail[32];
  std::snprintf(detail, sizeof detail, "%g", arguments.detail);
  std::map<std::string, std::string> items = {{"ARETE_COMMAND", common.command_line},
                                              {"ARETE_VERSION", ARETE_VERSION},
                                              {"ARETE_METHOD", arguments.method},
                                              {"ARETE_FACTOR", std::to_string(arguments.factor)},
                                              {"ARETE_DICTIONARY", dictionary_digest(dictionary)},
                                              {"ARETE_ATOMS", std::to_string(dictionary.atoms())},
                                              {"ARETE_PATCH_CELLS", std::to_string(dictionary.patch_cells)},
                                              {"ARETE_SPARSITY", std::to_string(arguments.sparsity)},
                                              {"ARETE_SELECTION", omp_selection},
                                              {"ARETE_SEED", std::to_string(common.seed)}};
  if (arguments.method == "consistent") items["ARETE_DETAIL"] = detail;
  std::string exemplars;
  for (const std::string& name : dictionary.exemplars) exemplars += (exemplars.empty() ? "" : ", ") + name;
  items["ARETE_EXEMPLARS"] = exemplars;
  return items;
}

DemWriteOptions writing(const AmplifyArguments& arguments, const CommonOptions& common) {
  DemWriteOptions options;
  options.format = arguments.format;
  options.overwrite = common.overwrite;
  options.memory_bytes = common.memory_bytes / 8;
  options.threads = common.threads;
  const auto add = [&](const char* band, const char* unit) {
    options.bands.push_back(band);
    options.band_units.push_back(unit);
  };
  options.bands.clear();
  add("elevation", "m");
  if (arguments.uncertainty) add("standard error", "m");
  if (arguments.sources) {
    add("exemplar", "");
    add("atom", "");
  }
  return options;
}

void warn_of_unlike(const AmplifyReport& report, const CommonOptions& common) {
  if (!report.unlike) return;
  char text[320];
  std::snprintf(text, sizeof text,
                "the exemplars are unlike this terrain: at their own scale its detail has %.2g times the power of theirs; the detail was scaled by "
                "%.2g to what the input supports. Better give exemplars of the same kind of ground",
                report.likeness, report.detail_scale);
  warn(common, text);
}

void run_amplify(const AmplifyArguments& arguments, const CommonOptions& common) {
  check_arguments(arguments);
  const DemReader dem(arguments.input, arguments.reading);
  const auto progress = make_progress(common);
  Dictionary dictionary = obtain_dictionary(arguments, dem, common, *progress);
  count_stages(arguments.factor, dictionary.factor);

  DemWriteOptions write_options = writing(arguments, common);
  write_options.metadata = describe_making(arguments, dictionary, common);
  const Size size{dem.size().width * arguments.factor, dem.size().height * arguments.factor};
  DemWriter writer(arguments.output, size, refine(dem.georeference(), arguments.factor), write_options);

  Raster<float> filled;
  std::optional<ViewSource> filled_source;
  if (arguments.fill) {
    filled = read_all(dem);
    fill_voids(filled.view());
    filled_source.emplace(std::as_const(filled).view());
  }
  AmplifyOptions options;
  options.method = method_of(arguments.method);
  options.factor = arguments.factor;
  options.detail = arguments.detail;
  options.sparsity = arguments.sparsity;
  options.uncertainty = arguments.uncertainty;
  options.sources = arguments.sources;
  options.threads = common.threads;
  options.memory_bytes = common.memory_bytes - common.memory_bytes / 4;  // the rest is the writer's and GDAL's
  const std::int64_t atoms = dictionary.atoms();
  const AmplifyReport report = amplify(filled_source ? static_cast<const RasterSource&>(*filled_source) : dem, std::move(dictionary), options,
                                       writer, *progress);
  writer.commit(progress.get());
  warn_of_unlike(report, common);

  const CellSize cell = dem.cell_size();
  char text[200];
  std::snprintf(text, sizeof text, ": %lld x %lld cells of %.4g x %.4g m, %s, %d stage%s, %lld atoms\n", static_cast<long long>(size.width),
                static_cast<long long>(size.height), cell.x_m / arguments.factor, cell.y_m / arguments.factor, arguments.method.c_str(),
                report.stages, report.stages == 1 ? "" : "s", static_cast<long long>(atoms));
  print_result(common, arguments.output + text,
               {{"output", arguments.output}, {"width", size.width}, {"height", size.height},
                {"cell_size_m", {cell.x_m / arguments.factor, cell.y_m / arguments.factor}}, {"stages", report.stages}, {"atoms", atoms},
                {"likeness", report.likeness > 0 ? nlohmann::json(report.likeness) : nlohmann::json(nullptr)},
                {"detail_scale", report.detail_scale}, {"metadata", write_options.metadata}});
}

}  // namespace

void add_amplify(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto a = std::make_shared<AmplifyArguments>();
  CLI::App* verb = add_verb(app, "amplify", "Make a DEM finer, with detail from real landforms",
                            "arete amplify coarse.tif fine.tif --factor 4 --exemplar lidar.tif\n"
                            "arete amplify coarse.tif fine.tif --factor 4 --dict alps.atoms --detail 0",
                            common, [a, common] { run_amplify(*a, *common); });
  verb->add_option("IN", a->input, "The DEM: anything that GDAL opens")->required();
  verb->add_option("OUT", a->output, "The finer DEM: a Cloud Optimized GeoTIFF, or by extension")->required();
  verb->add_option("--factor", a->factor, "How many times finer (default: 4); powers repeat, as 256 = 4 x 4 x 4 x 4")->check(CLI::Range(2, 4096));
  verb->add_option("--dict", a->dictionary, "Dictionary made by 'arete learn': a file, or the name of one that is shipped or in a folder of ARETE_DICTIONARIES");
  verb->add_option("--exemplar", a->exemplars, "Fine DEMs of the same kind of ground to learn from now");
  verb->add_option("--atoms", a->atoms, "Atoms to learn from the exemplars (default: 1024)")->check(CLI::Range(1, 1 << 20));
  verb->add_option("--method", a->method, "consistent: least-squares plus detail, keeps the input's means (default); paper: as published")
      ->check(CLI::IsMember({"consistent", "paper"}));
  verb->add_option("--detail", a->detail, "0: least error; 1: as much detail as real ground has (default: 1)")->check(CLI::Range(0.0, 1.0));
  verb->add_option("--radius", a->radius_m, "Radius of the landforms in metres (default: 3 cells of the input): larger keeps more of the exemplar")
      ->check(above_zero());
  verb->add_option("--sparsity", a->sparsity, "Atoms per patch (default: 1)")->check(CLI::Range(1, 32));
  verb->add_flag("--uncertainty", a->uncertainty, "Add a band with the standard error expected of each cell, in metres");
  verb->add_flag("--sources", a->sources, "Add bands with the exemplar (from 1) and the atom that each cell's detail comes from");
  verb->add_flag("--fill", a->fill, "Fill voids first, with the membrane that hangs on their rim; by default they stay voids");
  verb->add_option("--of", a->format, "Output format, GDAL's short name (default: by extension)");
  add_dem_options(verb, a->reading);
}

}  // namespace arete::tools
