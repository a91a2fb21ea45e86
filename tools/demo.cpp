// The main job on a sample: a terrain is cut in two, one half is degraded, a dictionary learned on the other half amplifies it,
// and the results are held against the truth.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/amplify/amplify.h"
#include "core/amplify/learn.h"
#include "core/sparse/dictionary_file.h"
#include "core/synthesis/mountains.h"
#include "core/terrain/compare.h"
#include "core/terrain/resample.h"
#include "core/terrain/spectrum.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "gis/geodesy.h"
#include "gis/relief.h"
#include "tools/command.h"
#include "tools/comparison_report.h"
#include "tools/dem_options.h"
#include "tools/output_folder.h"
#include "tools/preview_page.h"
#include "tools/report.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct DemoOptions {
  std::vector<std::string> paths;  // [IN] OUT
  DemReadOptions reading;
  int factor = 4;
  int atoms = LearnOptions{}.atoms;
};

struct Terrain {
  std::string name;
  Raster<float> cells;
  GeoReference geo;
};

/// What the methods are given, and what they should give back.
struct Trial {
  bool one_half = true;  // false: too small to cut; the example is the truth itself
  Terrain exemplar, truth, input;
  CellSize fine_cell, coarse_cell;
};

struct Outcome {
  std::string name, file, command = {};
  Raster<float> cells = {};
  double seconds = 0;
  Comparison error = {};
  SpectrumComparison spectrum = {};
};

std::string number(double value, int digits) {
  if (std::isnan(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

constexpr std::int64_t sample_side = 1024;
constexpr double sample_cell_m = 30;
constexpr std::uint64_t seed_offset = 4;       // so that the default seed puts mountains in both halves
constexpr std::int64_t close_side = 192;       // cells of the closer look
constexpr std::int64_t least_half_cells = 24;  // of the input; below that a half shows too little to learn from
// Bytes for each cell of the terrain: the halves, four results, and what learning and amplifying take beside them.
constexpr std::int64_t bytes_per_cell = 64;

/// UTM zone 32 north, whose ground is the Alps: a CRS that any GIS knows. The place is invented.
GeoReference sample_georeference() {
  GeoReference geo;
  geo.transform = {600000, sample_cell_m, 0, 5200000, 0, -sample_cell_m};
  geo.crs_wkt = crs_wkt("EPSG:32632");
  return geo;
}

Terrain make_sample(const CommonOptions& common) {
  MountainOptions options{.cell_size_m = sample_cell_m, .relief_m = 2000, .lowest_m = 400, .seed = common.seed + seed_offset, .threads = common.threads};
  return {"a made terrain", synthesize_mountains({sample_side, sample_side}, options), sample_georeference()};
}

/// The DEM, or as much of its middle as the memory allows.
Terrain read_terrain(const std::string& path, const DemReadOptions& options, const CommonOptions& common) {
  const DemReader reader(path, options);
  const Size size = reader.size();
  const double allowed = static_cast<double>(common.memory_bytes) / static_cast<double>(bytes_per_cell);
  const double share = std::min(1.0, std::sqrt(allowed / static_cast<double>(size.cells())));
  Window window{0, 0, size.width, size.height};
  if (share < 1) {
    window.width = static_cast<std::int64_t>(static_cast<double>(size.width) * share);
    window.height = static_cast<std::int64_t>(static_cast<double>(size.height) * share);
    window.x = (size.width - window.width) / 2;
    window.y = (size.height - window.height) / 2;
    warn(common, path + ": " + std::to_string(size.width) + " x " + std::to_string(size.height) + " cells are more than --memory " +
                     readable_bytes(common.memory_bytes) + " holds; the demo takes the " + std::to_string(window.width) + " x " +
                     std::to_string(window.height) + " in the middle");
  }
  Raster<float> cells(window.width, window.height);
  reader.read(window, cells.view());
  return {std::filesystem::path(path).filename().string(), std::move(cells), crop(reader.georeference(), window)};
}

std::int64_t valid_cells(const Raster<float>& cells) {
  return std::count_if(cells.data(), cells.data() + cells.size().cells(), [](float z) { return !is_void(z); });
}

Terrain cut(const Terrain& from, const std::string& name, const Window& window) {
  Raster<float> part(window.width, window.height);
  ViewSource(from.cells.view()).read(window, part.view());
  return {name, std::move(part), crop(from.geo, window)};
}

/// West half to learn from, east half to be degraded, both a multiple of the factor wide and high.
Trial make_trial(const Terrain& terrain, int factor, const CommonOptions& common) {
  const auto whole = [&](std::int64_t cells) { return cells / factor * factor; };
  const std::int64_t height = whole(terrain.cells.height()), half = whole(terrain.cells.width() / 2);
  Trial trial;
  trial.one_half = half >= least_half_cells * factor;
  const std::int64_t width = trial.one_half ? half : whole(terrain.cells.width());
  if (width < 2 * factor || height < 2 * factor)
    throw Error(ErrorKind::input, terrain.name + ": " + std::to_string(terrain.cells.width()) + " x " +
                                      std::to_string(terrain.cells.height()) + " cells are too few to degrade by a factor of " +
                                      std::to_string(factor) + "; give a larger DEM or a smaller --factor");
  if (!trial.one_half)
    warn(common, terrain.name + " is too small to be cut in two: it is learned from and amplified at once, which flatters the figures");
  trial.exemplar = cut(terrain, "exemplar.tif", {0, 0, width, height});
  trial.truth = cut(terrain, "truth.tif", {trial.one_half ? terrain.cells.width() - width : 0, 0, width, height});
  trial.input = {"input.tif", area_average(std::as_const(trial.truth.cells).view(), factor), coarsen(trial.truth.geo, factor)};
  const auto demand_elevations = [&](const Terrain& part, const std::string& where) {
    if (valid_cells(part.cells) == 0) throw Error(ErrorKind::input, terrain.name + ": no valid elevation " + where);
  };
  demand_elevations(trial.exemplar, trial.one_half ? "in its west half" : "in it");
  demand_elevations(trial.truth, trial.one_half ? "in its east half" : "in it");
  demand_elevations(trial.input, "is left when blocks of " + std::to_string(factor) + " x " + std::to_string(factor) + " cells are averaged");
  trial.fine_cell = cell_size(trial.truth.geo, trial.truth.cells.size());
  trial.coarse_cell = {trial.fine_cell.x_m * factor, trial.fine_cell.y_m * factor};
  return trial;
}

void write_dem(const OutputFolder& folder, const std::string& name, const Raster<float>& cells, const GeoReference& geo,
               const std::map<std::string, std::string>& metadata, const CommonOptions& common, Progress& progress) {
  DemWriteOptions options;
  options.metadata = metadata;
  options.memory_bytes = common.memory_bytes / 4;
  options.threads = common.threads;
  DemWriter writer(folder.file(name), cells.size(), geo, options);
  writer.write(0, {0, 0, cells.width(), cells.height()}, cells.view());
  writer.commit(&progress);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void compare_outcome(const Trial& trial, int factor, const CommonOptions& common, Outcome& outcome) {
  // Edges have fewer neighbours to learn from and to blend; they count like the rest.
  outcome.error = compare_terrain(trial.truth.cells.view(), outcome.cells.view(),
                                  {.cell = trial.fine_cell, .factor = factor, .threads = common.threads});
  outcome.spectrum = compare_spectra(trial.truth.cells.view(), outcome.cells.view(), {.factor = factor, .threads = common.threads});
}

/// The square of the truth where the terrain is roughest, for a closer look: of those that begin at multiples of half a side.
Window roughest_square(const Raster<float>& cells, std::int64_t side, int factor) {
  side = std::min({side, cells.width(), cells.height()}) / factor * factor;
  const std::int64_t step = std::max<std::int64_t>(side / 2 / factor * factor, factor);
  Window best{0, 0, side, side};
  double roughest = -1;
  for (std::int64_t y = 0; y + side <= cells.height(); y += step)
    for (std::int64_t x = 0; x + side <= cells.width(); x += step) {
      double sum = 0;
      for (std::int64_t j = y; j < y + side; ++j)
        for (std::int64_t i = x + 1; i + 1 < x + side; ++i) {
          const double bend = static_cast<double>(cells(i - 1, j)) - 2.0 * cells(i, j) + cells(i + 1, j);
          if (!std::isnan(bend)) sum += std::abs(bend);
        }
      if (sum > roughest) roughest = sum, best = {x, y, side, side};
    }
  return best;
}

/// Learns from the exemplar as `arete learn` does, and takes the dictionary as its file holds it, so that the commands of the report
/// give the same results.
Dictionary learn_exemplar(const Trial& trial, const OutputFolder& folder, const DemoOptions& demo, const CommonOptions& common,
                          Progress& progress) {
  const Exemplar exemplar{trial.exemplar.name, trial.exemplar.cells.view(), std::sqrt(trial.fine_cell.x_m * trial.fine_cell.y_m)};
  LearnOptions options;
  options.factor = demo.factor;
  options.atoms = demo.atoms;
  options.seed = common.seed;
  options.threads = common.threads;
  LearnReport report;
  Dictionary dictionary = learn_dictionary({exemplar}, options, report, progress);
  dictionary.provenance = common.command_line;
  const std::string file = folder.file("dictionary.atoms");
  write_dictionary(file, dictionary, false);
  return read_dictionary(file);
}

/// One row of the table: a method that makes the truth's size from the input.
Outcome amplify_input(const Trial& trial, const Dictionary& dictionary, AmplifyMethod method, double detail, const std::string& name,
                      const std::string& file, const DemoOptions& demo, const CommonOptions& common, Progress& progress) {
  Outcome outcome{.name = name, .file = file};
  AmplifyOptions options{.method = method, .factor = demo.factor, .detail = detail, .threads = common.threads,
                         .memory_bytes = common.memory_bytes};
  outcome.cells = Raster<float>(trial.truth.cells.width(), trial.truth.cells.height());
  ViewSink sink(outcome.cells.view());
  const auto start = std::chrono::steady_clock::now();
  const AmplifyReport report = amplify(ViewSource(trial.input.cells.view()), dictionary, options, sink, progress);
  outcome.seconds = seconds_since(start);
  if (report.unlike && detail > 0)
    warn(common, "the east half is unlike the west half that was learned from: the detail was scaled by " + number(report.detail_scale, 2));
  outcome.command = "arete amplify input.tif " + file + " --factor " + std::to_string(demo.factor) + " --dict dictionary.atoms" +
                    (method == AmplifyMethod::paper ? " --method paper" : " --detail " + number(detail, 0));
  return outcome;
}

std::vector<Outcome> run_methods(const Trial& trial, const Dictionary& dictionary, const DemoOptions& demo, const CommonOptions& common,
                                 Progress& progress) {
  std::vector<Outcome> outcomes;
  const auto start = std::chrono::steady_clock::now();
  Outcome bicubic{.name = "bicubic interpolation", .file = "bicubic.tif"};
  bicubic.cells = upsample_bicubic(trial.input.cells.view(), demo.factor);
  bicubic.seconds = seconds_since(start);
  const std::string percent = std::to_string(100 * demo.factor) + "%";
  bicubic.command = "gdal_translate -r cubic -outsize " + percent + " " + percent + " input.tif bicubic.tif    # nearly the same bicubic";
  outcomes.push_back(std::move(bicubic));
  outcomes.push_back(amplify_input(trial, dictionary, AmplifyMethod::consistent, 0, "arete, --detail 0 (least error)", "detail-0.tif",
                                   demo, common, progress));
  outcomes.push_back(amplify_input(trial, dictionary, AmplifyMethod::consistent, 1, "arete, --detail 1 (natural detail)", "detail-1.tif",
                                   demo, common, progress));
  outcomes.push_back(amplify_input(trial, dictionary, AmplifyMethod::paper, 1, "arete, --method paper", "paper.tif", demo, common, progress));
  for (Outcome& outcome : outcomes) compare_outcome(trial, demo.factor, common, outcome);
  return outcomes;
}

/// Input, bicubic, both ends of the detail knob, the paper's method, and the truth, side by side.
void draw_panels(const OutputFolder& folder, const std::string& name, const Trial& trial, const std::vector<Outcome>& outcomes,
                 const Window& window, std::int64_t panel_width, int factor, const CommonOptions& common, Progress& progress) {
  const Window coarse{window.x / factor, window.y / factor, window.width / factor, window.height / factor};
  std::vector<ViewSource> sources;
  sources.reserve(outcomes.size() + 2);
  std::vector<ReliefPanel> panels;
  const auto add = [&](const std::string& caption, const Raster<float>& cells, const Window& part, CellSize cell) {
    sources.emplace_back(cells.view().sub(part));
    panels.push_back({caption, &sources.back(), cell});
  };
  add("input", trial.input.cells, coarse, trial.coarse_cell);
  for (const Outcome& outcome : outcomes) add(outcome.name, outcome.cells, window, trial.fine_cell);
  add("truth", trial.truth.cells, window, trial.fine_cell);
  ReliefOptions options;
  options.width = panel_width;
  options.threads = common.threads;
  options.metric = trial.truth.geo.transform.has_value();
  const Relief relief = draw_relief_panels(panels, 3, options, progress);
  write_picture(folder.file(name), relief.picture);
}

void draw_error(const OutputFolder& folder, const std::string& name, const Trial& trial, const Outcome& outcome, double limit_m,
                const CommonOptions& common, Progress& progress) {
  ReliefOptions options;
  options.width = 384;
  options.threads = common.threads;
  options.metric = trial.truth.geo.transform.has_value();
  const Relief map = draw_difference_map(ViewSource(trial.truth.cells.view()), ViewSource(outcome.cells.view()), trial.fine_cell,
                                         limit_m, options, progress);
  write_picture(folder.file(name), map.picture);
}

std::vector<std::string> table_columns(const std::vector<Outcome>& outcomes) {
  std::vector<std::string> columns = {"method", "RMSE (m)", "PSNR (dB)", "largest error (m)", "slope RMSE (degrees)", "consistency (m)"};
  for (const BandPower& band : outcomes.front().spectrum.bands)
    columns.push_back("detail of " + number(1 / band.upper, 0) + " to " + number(1 / band.lower, 0) + " cells, of the truth's");
  columns.push_back("time (s)");
  return columns;
}

std::vector<std::string> table_row(const Outcome& outcome) {
  const Comparison& error = outcome.error;
  std::vector<std::string> row = {outcome.name, number(error.rmse_m, 3), number(error.psnr_db, 2), number(error.max_m, 1),
                                  number(error.slope_rmse_deg, 2), number(error.consistency_m.value_or(NAN), 6)};
  for (const BandPower& band : outcome.spectrum.bands) row.push_back(number(100 * band.ratio(), 0) + " %");
  row.push_back(number(outcome.seconds, 2));
  return row;
}

/// Puts the pictures into the folder and into the report.
void add_pictures(Report& report, const OutputFolder& folder, const Trial& trial, const std::vector<Outcome>& outcomes,
                  const DemoOptions& demo, const CommonOptions& common, Progress& progress) {
  const auto add = [&](const std::string& name, const std::string& caption) {
    report.pictures.push_back({caption, folder.file(name)});
  };
  const std::int64_t width = trial.truth.cells.width(), height = trial.truth.cells.height();
  draw_panels(folder, "closer.png", trial, outcomes, roughest_square(trial.truth.cells, close_side, demo.factor), 512, demo.factor, common, progress);
  add("closer.png", "A closer look at the roughest part: what was given, what each method made of it, and what it really is.");
  draw_panels(folder, "whole.png", trial, outcomes, {0, 0, width, height}, 384, demo.factor, common, progress);
  add("whole.png", "The whole piece that was amplified.");
  const double limit_m = std::max(outcomes.front().error.p99_m, 1e-3);
  for (const Outcome& outcome : outcomes) {
    if (outcome.file == "paper.tif") continue;  // an error so much larger would take the scale from the others
    const std::string name = "error-" + std::filesystem::path(outcome.file).stem().string() + ".png";
    draw_error(folder, name, trial, outcome, limit_m, common, progress);
    add(name, "Error of " + outcome.name + ": blue where it is too low, red where it is too high.");
  }
}

/// What was given and what was made of it, on a page that turns. Without georeference only rasters of one size lie on each other.
void add_terrain_page(Report& report, const OutputFolder& folder, const std::string& before, const CommonOptions& common, Progress& progress) {
  PageArguments arguments{.input = folder.file(before), .output = folder.file("terrain.html"), .compare = folder.file("detail-1.tif"), .reading = {}, .relief = {}};
  arguments.relief.threads = common.threads;
  write_terrain_page(arguments.output, make_preview_page(arguments, common, progress));
  report.frames.push_back({"Before and after",
                           "Left of the line " + before + ", right of it detail-1.tif: draw the line to compare, drag the terrain to turn it. "
                           "The same page fills a window as terrain.html.",
                           arguments.output});
}

Report make_report(const Terrain& terrain, const Trial& trial, const std::vector<Outcome>& outcomes, const DemoOptions& demo,
                   const CommonOptions& common, double learning_s) {
  const std::string factor = std::to_string(demo.factor), metres = number(trial.fine_cell.x_m, 1);
  Report report;
  report.title = "Arete on " + terrain.name;
  report.introduction = {
      trial.one_half
          ? "The terrain (" + std::to_string(terrain.cells.width()) + " x " + std::to_string(terrain.cells.height()) + " cells of " + metres +
                " m) was cut in two. Arete learned from the west half. The east half was averaged over blocks of " + factor + " x " + factor +
                " cells, and from that average alone each method rebuilt it; what it really is, is known, so every error can be measured."
          : "The terrain (" + std::to_string(terrain.cells.width()) + " x " + std::to_string(terrain.cells.height()) + " cells of " + metres +
                " m) is too small to be cut in two: Arete learned from the very cells that it was then asked for, which flatters its figures.",
      "Detail 0 gives the smallest error: what the input determines, and nothing invented. Detail 1 adds as much detail as the "
      "terrain has by nature, from pieces of the example: plausible, but not measured at that place. Both keep the average of each "
      "input cell. The paper method is the published algorithm."};
  report.columns = table_columns(outcomes);
  for (const Outcome& outcome : outcomes) report.rows.push_back(table_row(outcome));
  report.table_note = "Over " + std::to_string(outcomes.front().error.cells) + " valid cells. PSNR = 20 log10(peak / RMSE), peak = " +
                      number(outcomes.front().error.peak_m, 1) + " m, the relief of the truth. Consistency: RMSE between the input and the "
                      "average of the result. Detail: power of the result in octaves that the input cannot show, over that of the truth. "
                      "Learning took " + number(learning_s, 2) + " s.";
  report.footer = "arete " ARETE_VERSION ": " + common.command_line;
  return report;
}

std::vector<std::string> reproducing_commands(const Terrain& terrain, const std::vector<Outcome>& outcomes, const DemoOptions& demo,
                                              const std::string& before, const CommonOptions& common) {
  const std::string factor = std::to_string(demo.factor);
  std::vector<std::string> commands = {"# in this folder; " + std::string("exemplar.tif, truth.tif and input.tif were made from ") + terrain.name,
                                       "arete learn exemplar.tif dictionary.atoms --overwrite --factor " + factor + " --atoms " +
                                           std::to_string(demo.atoms) + " --seed " + std::to_string(common.seed)};
  for (const Outcome& outcome : outcomes) {
    commands.push_back(outcome.command + (outcome.command.rfind("arete", 0) == 0 ? " --overwrite" : ""));
    commands.push_back("arete compare truth.tif " + outcome.file + " --factor " + factor);
  }
  commands.push_back("arete preview detail-1.tif detail-1.png");
  commands.push_back("arete preview " + before + " terrain.html --compare detail-1.tif --overwrite");
  return commands;
}

nlohmann::json describe_as_json(const std::vector<Outcome>& outcomes, const Trial& trial, const DemoOptions& demo) {
  nlohmann::json methods = nlohmann::json::array();
  for (const Outcome& outcome : outcomes) {
    nlohmann::json entry = comparison_json({"truth.tif", outcome.file, trial.fine_cell, demo.factor, {}}, outcome.error, outcome.spectrum);
    entry["method"] = outcome.name;
    entry["seconds"] = outcome.seconds;
    methods.push_back(entry);
  }
  return methods;
}

std::string describe_outcomes(const std::vector<Outcome>& outcomes, const std::string& page) {
  std::string text;
  char line[160];
  std::snprintf(line, sizeof line, "%-36s %10s %10s %14s\n", "", "RMSE", "PSNR", "consistency");
  text += line;
  for (const Outcome& outcome : outcomes) {
    std::snprintf(line, sizeof line, "%-36s %8.3f m %7.2f dB %12.2g m\n", outcome.name.c_str(), outcome.error.rmse_m, outcome.error.psnr_db,
                  outcome.error.consistency_m.value_or(NAN));
    text += line;
  }
  return text + "report: " + page + "\n";
}

void write_page(const std::string& path, const Report& report) {
  std::ofstream file(path);
  file << write_html(report);
  file.close();
  if (!file) throw Error(ErrorKind::disk, path + ": cannot write the report; is the disk full?");
}

void run_demo(const DemoOptions& demo, const CommonOptions& common) {
  const std::string out = demo.paths.back();
  OutputFolder folder(out, common.overwrite);
  const auto progress = make_progress(common);

  const Terrain terrain = demo.paths.size() == 1 ? make_sample(common) : read_terrain(demo.paths.front(), demo.reading, common);
  const Trial trial = make_trial(terrain, demo.factor, common);
  const auto start = std::chrono::steady_clock::now();
  const Dictionary dictionary = learn_exemplar(trial, folder, demo, common, *progress);
  const double learning_s = seconds_since(start);
  std::vector<Outcome> outcomes = run_methods(trial, dictionary, demo, common, *progress);

  const std::map<std::string, std::string> made = {{"ARETE_COMMAND", common.command_line}};
  if (demo.paths.size() == 1) write_dem(folder, "terrain.tif", terrain.cells, terrain.geo, made, common, *progress);
  for (const Terrain* part : {&trial.exemplar, &trial.truth, &trial.input}) write_dem(folder, part->name, part->cells, part->geo, made, common, *progress);
  for (const Outcome& outcome : outcomes) write_dem(folder, outcome.file, outcome.cells, trial.truth.geo, made, common, *progress);

  Report report = make_report(terrain, trial, outcomes, demo, common, learning_s);
  add_pictures(report, folder, trial, outcomes, demo, common, *progress);
  const std::string before = trial.input.geo.transform ? "input.tif" : "bicubic.tif";
  add_terrain_page(report, folder, before, common, *progress);
  report.commands = reproducing_commands(terrain, outcomes, demo, before, common);
  write_page(folder.file("index.html"), report);
  folder.publish();
  const std::string page = (std::filesystem::path(out) / "index.html").lexically_normal().string();
  print_result(common, describe_outcomes(outcomes, page), {{"report", page}, {"methods", describe_as_json(outcomes, trial, demo)}});
}

}  // namespace

void add_demo(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto demo = std::make_shared<DemoOptions>();
  CLI::App* verb = add_verb(app, "demo", "Amplify half of a terrain from the other half, and show how near the truth it comes",
                            "arete demo demo-report\narete demo my.tif my-report --factor 3", common, [demo, common] { run_demo(*demo, *common); });
  verb->add_option("[IN] OUT", demo->paths, "A DEM (without it a terrain is made), and the folder to make")
      ->required()->expected(1, 2)->type_name("");
  add_dem_options(verb, demo->reading);
  verb->add_option("--factor", demo->factor, "How many times finer; default: 4")->check(CLI::Range(2, 16))->type_name("N");
  verb->add_option("--atoms", demo->atoms, "Atoms of the dictionary; default: 1024")->check(CLI::Range(1, 100000))->type_name("N");
}

}  // namespace arete::tools
