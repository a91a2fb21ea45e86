#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/sparse/dictionary_file.h"
#include "gis/staged_files.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/exemplars.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct LearnArguments {
  std::vector<std::string> files;  // exemplars, then the output
  LearnSettings settings;
  double radius_m = 0;
};

std::string describe(const std::string& output, const Dictionary& dictionary, const LearnReport& report, double seconds) {
  char text[320];
  std::snprintf(text, sizeof text, "%s: %lld atoms of %d x %d cells, factor %d, from %lld of %lld patches in %.1f s\n", output.c_str(),
                static_cast<long long>(dictionary.atoms()), dictionary.patch_cells, dictionary.patch_cells, dictionary.factor,
                static_cast<long long>(report.trained), static_cast<long long>(report.patches), seconds);
  std::string lines = text;
  if (report.objective.size() > 1) {
    std::snprintf(text, sizeof text, "squared error of the training patches: %.4g at first, %.4g after %zu rounds\n", report.objective.front(),
                  report.objective.back(), report.objective.size() - 1);
    lines += text;
  }
  return lines;
}

void run_learn(const LearnArguments& arguments, const CommonOptions& common) {
  if (arguments.files.size() < 2)
    throw Error(ErrorKind::usage, "give at least one exemplar and the output: arete learn EXEMPLAR... OUT.atoms");
  const std::vector<std::string> exemplars(arguments.files.begin(), arguments.files.end() - 1);
  const std::string& output = arguments.files.back();
  StagedFiles(output, common.overwrite);  // refuses now what could not be written after the work
  const auto start = std::chrono::steady_clock::now();
  const auto progress = make_progress(common);
  const LearnedDictionary learned = learn_from_files(exemplars, arguments.settings, arguments.radius_m, common, *progress);
  write_dictionary(output, learned.dictionary, common.overwrite);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Dictionary& dictionary = learned.dictionary;
  print_result(common, describe(output, dictionary, learned.report, seconds),
               {{"output", output},
                {"digest", dictionary_digest(dictionary)},
                {"method", arguments.settings.method},
                {"atoms", dictionary.atoms()},
                {"patch_cells", dictionary.patch_cells},
                {"factor", dictionary.factor},
                {"patches", learned.report.patches},
                {"trained", learned.report.trained},
                {"objective", learned.report.objective},
                {"detail_power", dictionary.detail_power},
                {"seconds", seconds}});
}

}  // namespace

void add_learn(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto a = std::make_shared<LearnArguments>();
  CLI::App* verb = add_verb(app, "learn", "Learn a dictionary of landforms from fine DEMs",
                            "arete learn lidar_a.tif lidar_b.tif alps.atoms --factor 4 --atoms 512", common,
                            [a, common] { run_learn(*a, *common); });
  verb->add_option("EXEMPLAR... OUT", a->files, "Fine DEMs to learn from, and last the dictionary to write (.atoms)")->required();
  verb->add_option("--method", a->settings.method,
                   "constrained: real patches, chosen to represent the others (default); ksvd: free atoms; all: every patch")
      ->check(CLI::IsMember({"all", "ksvd", "constrained"}));
  verb->add_option("--atoms", a->settings.atoms, "Atoms (default: 1024; with --method all: every patch)")->check(CLI::Range(1, 1 << 22));
  verb->add_option("--sparsity", a->settings.sparsity, "Atoms per patch while learning (default: 1)")->check(CLI::Range(1, 32));
  verb->add_option("--radius", a->radius_m, "Radius of the patches in metres (default: 3 coarse cells)")->check(above_zero());
  verb->add_option("--factor", a->settings.factor, "How many times finer the exemplar is than what will be amplified (default: 4)")
      ->check(CLI::Range(2, 64));
  verb->add_flag("--symmetries", a->settings.symmetries, "Learn also from the 7 other rotations and mirrors of each patch");
  verb->add_flag("--exhaustive", a->settings.exhaustive, "Constrained learning without the nearest-patch index: slower, exact");
  add_dem_options(verb, a->settings.reading);
}

}  // namespace arete::tools
