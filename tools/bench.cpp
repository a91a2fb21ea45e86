#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/support/parallel.h"
#include "gis/dem_file.h"
#include "gis/peer_codecs.h"
#include "tools/bench_data.h"
#include "tools/bench_page.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/output_folder.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct BenchOptions {
  std::string kind;
  std::vector<std::string> paths;  // DEM... OUT
  std::vector<std::string> peers;
  std::vector<double> rates, bounds;
  bool lossless = false, fill = false, paper = false;
  int repeats = 3;
  DemReadOptions reading;
};

// The terrain, its filled copy, and the decoded terrain.
constexpr std::int64_t terrain_bytes_per_cell = 12;

const std::vector<double> default_rates = {0.02, 0.05, 0.1, 0.2, 0.5, 1, 2};

using Codecs = std::vector<std::unique_ptr<CodecUnderTest>>;

Codecs choose_codecs(const std::vector<std::string>& names) {
  Codecs codecs = all_codecs();
  if (!names.empty())
    std::erase_if(codecs, [&](const auto& codec) { return std::find(names.begin(), names.end(), codec->name()) == names.end(); });
  return codecs;
}

std::vector<std::string> codec_names() {
  std::vector<std::string> names;
  for (const auto& codec : all_codecs()) names.push_back(codec->name());
  return names;
}

/// A codec is judged on the whole DEM: throws where the hungriest of them has not the memory for it.
void demand_memory(const DemReader& reader, const Codecs& codecs, const CommonOptions& common) {
  std::int64_t bytes_per_cell = 0;
  for (const auto& codec : codecs) bytes_per_cell = std::max(bytes_per_cell, terrain_bytes_per_cell + codec->bytes_per_cell());
  const Size size = reader.size();
  if (size.cells() > common.memory_bytes / bytes_per_cell)
    throw Error(ErrorKind::memory, reader.path() + ": to compress " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                                       " cells whole takes up to " + readable_bytes(size.cells() * bytes_per_cell) + ", --memory is " +
                                       readable_bytes(common.memory_bytes) + "; give more, fewer codecs (--peers), or a part of the DEM (gdal_translate -srcwin)");
}

/// The terrain without voids. Filled cells are whole quanta where all others are: data of whole metres stay such.
TestedTerrain filled_terrain(const TestedTerrain& terrain, double unit) {
  Raster<float> cells = terrain.filled.clone();
  for (std::int64_t i = 0; i < cells.size().cells() && terrain.quantum > 0; ++i)
    if (is_void(terrain.cells.data()[i])) cells.data()[i] = static_cast<float>(std::round(static_cast<double>(cells.data()[i]) / terrain.quantum) * terrain.quantum);
  return examine_terrain(terrain.name, std::move(cells), unit);
}

TestedTerrain read_terrain(const std::string& path, const DemReadOptions& reading, bool fill) {
  const DemReader reader(path, reading);
  const double unit = reader.georeference().metres_per_unit;
  TestedTerrain terrain = examine_terrain(path, read_all(reader), unit);
  return fill && terrain.valid < terrain.cells.size().cells() ? filled_terrain(terrain, unit) : std::move(terrain);
}

/// What the options ask for; where they name no part, all of them.
TrialPlan make_plan(const BenchOptions& options, const TestedTerrain& terrain, const CommonOptions& common) {
  const bool all = options.rates.empty() && options.bounds.empty() && !options.lossless;
  TrialPlan plan;
  plan.rates = all ? default_rates : options.rates;
  plan.bounds_m = options.bounds;
  if (all) {
    plan.bounds_m = default_bounds(terrain);
    // Data in centimetres are lossless within 0 m for codecs of whole numbers, while their floats are what GeoTIFF stores losslessly.
    if (terrain.quantum > 0 && terrain.quantum < 1) plan.bounds_m.insert(plan.bounds_m.begin(), 0);
  }
  plan.lossless = all || options.lossless;
  plan.repeats = options.repeats;
  plan.threads = resolve_threads(common.threads);
  return plan;
}

/// Names that files can have, no two equal.
std::vector<std::string> make_labels(const std::vector<std::string>& paths) {
  std::set<std::string> used;
  std::vector<std::string> labels;
  for (const std::string& path : paths) {
    const std::string stem = std::filesystem::path(path).stem().string();
    std::string label = stem;
    for (int count = 2; !used.insert(label).second; ++count) label = stem + "-" + std::to_string(count);
    labels.push_back(label);
  }
  return labels;
}

BenchedDem bench_dem(const std::string& path, const std::string& label, const Codecs& codecs, const BenchOptions& options, const CommonOptions& common,
                     Progress& progress) {
  const TestedTerrain terrain = read_terrain(path, options.reading, options.fill);
  BenchedDem dem{path, label, terrain.cells.size(), terrain.valid, terrain.low, terrain.high, terrain.quantum, make_plan(options, terrain, common), {}, {}};
  progress.begin(label, trial_steps(dem.plan) * static_cast<std::int64_t>(codecs.size()) + (options.paper ? std::ssize(paper_sparsities) : 0));
  for (const auto& codec : codecs) dem.trials.push_back(try_codec(*codec, terrain, dem.plan, progress));
  if (options.paper) dem.paper = try_paper_profile(terrain, *make_openjpeg_codec(), dem.plan.threads, progress);
  progress.end();
  return dem;
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw Error(ErrorKind::disk, path + ": cannot write; is the disk full?");
}

void write_plot(const OutputFolder& folder, const std::string& name, const LinePlot& plot) {
  write_text(folder.file(name + ".svg"), line_plot_svg(plot));
  write_picture(folder.file(name + ".png"), draw_line_plot(plot, 2));
}

void write_plots(const OutputFolder& folder, const BenchedDem& dem) {
  if (!dem.plan.rates.empty()) write_plot(folder, dem.label + "-psnr", psnr_plot(dem));
  if (!dem.plan.rates.empty() || !dem.plan.bounds_m.empty()) write_plot(folder, dem.label + "-max-error", max_error_plot(dem));
  if (!dem.plan.bounds_m.empty()) write_plot(folder, dem.label + "-bounds", bound_plot(dem));
}

void run_bench(const BenchOptions& options, const CommonOptions& common) {
  const std::vector<std::string> inputs(options.paths.begin(), options.paths.end() - 1);
  OutputFolder folder(options.paths.back(), common.overwrite);
  if (find_font().empty()) warn(common, "no font found, the PNG plots have no words: install fonts-dejavu-core or set ARETE_FONT");
  const auto progress = make_progress(common);
  const Codecs codecs = choose_codecs(options.peers);
  const std::vector<std::string> labels = make_labels(inputs);

  // A DEM that cannot be read, or is too large, is found now, not after an hour.
  for (const std::string& path : inputs) demand_memory(DemReader(path, options.reading), codecs, common);
  std::vector<BenchedDem> dems;
  for (std::size_t i = 0; i < inputs.size(); ++i) dems.push_back(bench_dem(inputs[i], labels[i], codecs, options, common, *progress));

  nlohmann::json data = bench_json(dems);
  data["command"] = common.command_line;
  data["version"] = ARETE_VERSION;
  write_text(folder.file("results.csv"), bench_csv(dems));
  if (options.paper) write_text(folder.file("paper.csv"), paper_csv(dems));
  for (const BenchedDem& dem : dems) write_plots(folder, dem);
  write_text(folder.file("report.html"), write_html(bench_page(dems, common.command_line)));
  write_text(folder.file("results.json"), data.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  folder.publish();
  const std::string page = (std::filesystem::path(options.paths.back()) / "report.html").lexically_normal().string();
  data["report"] = page;
  print_result(common, bench_text(dems) + "report: " + page + "\n", data);
}

}  // namespace

void add_bench(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* verb = add_verb(app, "bench", "Compress DEMs with several codecs and compare size, error and time",
                            "arete bench compression dem.tif report\narete bench compression *.tif report --peers openjpeg,jpegxl --rates 0.1,0.5,1\n"
                            "arete bench compression dem.tif report --bounds 0.5,1,5 --lossless",
                            common, [options, common] { run_bench(*options, *common); });
  verb->add_option("KIND", options->kind, "What to measure: compression")->required()->check(CLI::IsMember({"compression"}));
  verb->add_option("DEM... OUT", options->paths, "DEMs, and the folder to make for the results")->required()->expected(2, 1000000)->type_name("");
  add_dem_options(verb, options->reading);
  verb->add_option("--peers", options->peers, "Only these codecs, with commas between; default: all")
      ->delimiter(',')->check(CLI::IsMember(codec_names()));
  verb->add_option("--rates", options->rates, "Measure error at these bits per sample; default: 0.02,0.05,0.1,0.2,0.5,1,2")
      ->delimiter(',')->check(CLI::Range(1e-4, 64.0))->type_name("LIST");
  verb->add_option("--bounds", options->bounds, "Measure size at these strict errors in metres; default: five that suit the relief")
      ->delimiter(',')->check(CLI::NonNegativeNumber)->type_name("LIST");
  verb->add_flag("--lossless", options->lossless, "Measure lossless size. Where --rates, --bounds or --lossless is given, only those parts are run");
  verb->add_flag("--paper", options->paper, "Add the published sparse tree (128 atoms; 1, 2 and 8 coefficients) beside JPEG 2000 in as many bytes; takes minutes");
  verb->add_flag("--fill", options->fill, "Interpolate voids first, so that every codec gets the same raster and none pays for a mask");
  verb->add_option("--repeats", options->repeats, "Runs that times are the median of; default: 3")->check(CLI::Range(1, 99))->type_name("N");
}

}  // namespace arete::tools
