#include <memory>
#include <string>

#include "core/terrain/compare.h"
#include "core/terrain/spectrum.h"
#include "gis/alignment.h"
#include "gis/dem_file.h"
#include "gis/relief.h"
#include "gis/warp.h"
#include "tools/command.h"
#include "tools/comparison_report.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct CompareArguments {
  std::string reference, result, map;
  int factor = 0, band = 1;
  std::int64_t border = 0, map_width = 0;
  bool resample = false, terrain_rgb = false;
};

/// The two rasters cell on cell.
struct Pair {
  std::unique_ptr<DemReader> reference_file, result_file;
  std::unique_ptr<WarpedSource> warped;
  std::unique_ptr<CroppedSource> reference, result;
  Alignment alignment;
};

Pair open_pair(const CompareArguments& arguments) {
  Pair pair;
  const DemReadOptions reading{.band = arguments.band, .terrain_rgb = arguments.terrain_rgb};
  pair.reference_file = std::make_unique<DemReader>(arguments.reference, reading);
  pair.result_file = std::make_unique<DemReader>(arguments.result, reading);
  const GeoReference& geo = pair.reference_file->georeference();
  const Size size = pair.reference_file->size();
  const RasterSource* result = pair.result_file.get();
  if (arguments.resample) {
    if (!geo.transform || !pair.result_file->georeference().transform)
      throw Error(ErrorKind::input, "cannot resample: '" + (geo.transform ? arguments.result : arguments.reference) +
                                        "' has no georeference");
    pair.warped = std::make_unique<WarpedSource>(*result, pair.result_file->georeference(), geo, size);
    result = pair.warped.get();
    pair.alignment = {{0, 0, size.width, size.height}, {0, 0, size.width, size.height}, {"the result was resampled (cubic)"}};
  } else {
    pair.alignment = align_grids({arguments.reference, geo, size},
                                 {arguments.result, pair.result_file->georeference(), pair.result_file->size()});
  }
  pair.reference = std::make_unique<CroppedSource>(*pair.reference_file, pair.alignment.reference);
  pair.result = std::make_unique<CroppedSource>(*result, pair.alignment.result);
  return pair;
}

void run_compare(const CompareArguments& arguments, const CommonOptions& common) {
  if (!arguments.map.empty()) check_picture_path(arguments.map, common.overwrite);
  const Pair pair = open_pair(arguments);
  const auto progress = make_progress(common);
  const ComparisonSubject subject{arguments.reference, arguments.result, pair.reference_file->cell_size(), arguments.factor,
                                  pair.alignment.notes};
  CompareOptions how;
  how.cell = subject.cell;
  how.border = arguments.border;
  how.factor = arguments.factor;
  how.threads = common.threads;
  Comparison comparison = compare_terrain(*pair.reference, *pair.result, how, *progress);
  SpectrumOptions spectral;
  spectral.factor = arguments.factor > 1 ? arguments.factor : 4;
  spectral.border = arguments.border;
  spectral.threads = common.threads;
  const SpectrumComparison spectra = compare_spectra(*pair.reference, *pair.result, spectral, *progress);
  if (comparison.cells > 0) {
    // In cells of the reference as the user knows it.
    comparison.max_x += pair.alignment.reference.x;
    comparison.max_y += pair.alignment.reference.y;
  }
  if (!arguments.map.empty()) {
    ReliefOptions drawing;
    drawing.width = arguments.map_width;
    drawing.threads = common.threads;
    drawing.metric = pair.reference_file->georeference().transform.has_value();
    if (find_font().empty()) warn(common, "no font found, the map has no legend: install fonts-dejavu-core or set ARETE_FONT");
    const Relief map = draw_difference_map(*pair.reference, *pair.result, subject.cell, comparison.p99_m, drawing, *progress);
    write_picture(arguments.map, map.picture, common.overwrite);
  }
  print_result(common, describe_comparison(subject, comparison, spectra), comparison_json(subject, comparison, spectra));
}

}  // namespace

void add_compare(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* verb = add_verb(app, "compare", "Compare a DEM with a reference: heights, slopes, consistency, detail",
                            "arete compare truth.tif amplified.tif --factor 4 --map error.png", common,
                            [arguments, common] { run_compare(*arguments, *common); });
  verb->add_option("REFERENCE", arguments->reference, "The DEM taken as the truth")->required();
  verb->add_option("RESULT", arguments->result, "The DEM to be judged")->required();
  verb->add_option("--factor", arguments->factor, "Factor of the amplification: adds the consistency, and sets the bands of detail")
      ->check(CLI::Range(2, 4096));
  verb->add_option("--border", arguments->border, "Leave out this many cells along each side")->check(CLI::NonNegativeNumber);
  verb->add_option("--map", arguments->map, "Draw the error to this picture (.png, .tif, .exr)");
  verb->add_option("--width", arguments->map_width, "Width of that picture in pixels at most")->check(CLI::Range(16, 20000));
  verb->add_flag("--resample", arguments->resample, "Bring the result onto the grid of the reference first (cubic)");
  verb->add_option("--band", arguments->band, "Band of both files, counted from 1")->check(CLI::PositiveNumber);
  verb->add_flag("--terrain-rgb", arguments->terrain_rgb, "Both hold Mapbox terrain-RGB");
}

}  // namespace arete::tools
