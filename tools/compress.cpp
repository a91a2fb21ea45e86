#include "core/tree/compress.h"

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/sparse/dictionary_file.h"
#include "core/support/file.h"
#include "gis/crs.h"
#include "gis/dem_file.h"
#include "gis/dictionary_search.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/stored_dem.h"
#include "tools/tree_report.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct CompressArguments {
  std::string input, output;
  DemReadOptions dem;
  double psnr = 0, rmse = 0, bytes = 0, bits_per_sample = 0, max_error = 0;
  bool lossless = false, fast = false;
  std::string flat = "auto", profile = "best", learning = "ksvd", dictionary;
  int radius = 0;  // 0: that of the dictionary, or the coder's default
  PatchCodingOptions patches;
};

// Farther from its own cells than this a dictionary's landforms are of another kind.
constexpr double spacing_tolerance = 2;

CompressionTarget target_of(const CompressArguments& arguments, const Size& size) {
  if (arguments.psnr > 0) return {TreeClaim::psnr, arguments.psnr};
  if (arguments.rmse > 0) return {TreeClaim::rmse, arguments.rmse};
  if (arguments.bytes > 0) return {TreeClaim::bytes, arguments.bytes};
  if (arguments.bits_per_sample > 0)
    return {TreeClaim::bytes, std::floor(arguments.bits_per_sample * static_cast<double>(size.cells()) / 8)};
  if (arguments.max_error > 0) return {TreeClaim::max_error, arguments.max_error};
  return {TreeClaim::lossless, 0};
}

TreeHeader header_of(const DemReader& dem) {
  const DemDescription& about = dem.description();
  TreeHeader header;
  header.type = dem.value_type();
  header.scale = about.scale;
  header.offset = about.offset;
  header.geo = dem.georeference();
  header.geo.crs_wkt = shorten_crs(header.geo.crs_wkt);
  header.band_name = about.band_names.empty() ? "" : about.band_names.front();
  header.metadata = about.metadata;
  return header;
}

void check_fit(const CompressArguments& arguments, const FoundDictionary& given, const DemReader& dem, const CommonOptions& common) {
  const Dictionary& dictionary = given.dictionary;
  const int radius = dictionary.patch_cells / 2;
  if (radius < least_patch_radius || radius > greatest_patch_radius || dictionary.atoms() > most_patch_atoms)
    throw Error(ErrorKind::usage, fmt::format("'{}' has {} atoms with a radius of {} cells: the paper's profile takes up to {} of {} to {} cells", given.path,
                                              dictionary.atoms(), radius, most_patch_atoms, least_patch_radius, greatest_patch_radius));
  if (arguments.radius != 0 && arguments.radius != radius)
    throw Error(ErrorKind::usage, fmt::format("--radius is {} cells, the atoms of '{}' have {}: leave --radius out, or give another dictionary", arguments.radius,
                                              given.path, radius));
  if (dictionary.cell_size_m <= 0 || !dem.georeference().transform) return;
  const CellSize cell = dem.cell_size();
  const double ratio = std::sqrt(cell.x_m * cell.y_m) / dictionary.cell_size_m;
  if (ratio > spacing_tolerance || ratio < 1 / spacing_tolerance)
    warn(common, fmt::format("'{}' holds landforms on cells of {:.4g} m, '{}' has cells of {:.4g} m: a dictionary of {:.4g} to {:.4g} m fits it better", given.path,
                             dictionary.cell_size_m, arguments.input, ratio * dictionary.cell_size_m, ratio * dictionary.cell_size_m / spacing_tolerance,
                             ratio * dictionary.cell_size_m * spacing_tolerance));
}

// The dictionary that the command line names, with the sizes of its file.
std::optional<FoundDictionary> read_given(const CompressArguments& arguments, const DemReader& dem, const CommonOptions& common) {
  if (arguments.dictionary.empty()) return std::nullopt;
  if (arguments.profile != "paper") throw Error(ErrorKind::usage, "--dictionary is of --profile paper: the other coders have none");
  const std::string path = locate_dictionary(arguments.dictionary);
  FoundDictionary given{path, 0, read_dictionary(path)};
  given.bytes = std::filesystem::file_size(path);
  check_fit(arguments, given, dem, common);
  return given;
}

void run_compress(const CompressArguments& arguments, const CommonOptions& common) {
  check_output_file(arguments.output, common.overwrite);
  const DemReader dem(arguments.input, arguments.dem);
  CompressOptions options;
  options.target = target_of(arguments, dem.size());
  options.passes = arguments.fast ? 1 : 2;
  options.profile = arguments.profile == "paper" ? TreeProfile::paper : TreeProfile::best;
  options.patches = arguments.patches;
  options.patches.learning = arguments.learning == "ksvd" ? PatchLearning::ksvd : PatchLearning::constrained;
  options.patches.seed = common.seed;
  if (arguments.radius != 0) options.patches.radius = arguments.radius;
  const std::optional<FoundDictionary> given = read_given(arguments, dem, common);
  if (given) {
    options.patches.dictionary = &given->dictionary.low;
    options.patches.dictionary_name = dictionary_digest(given->dictionary);
    options.patches.radius = given->dictionary.patch_cells / 2;
  }
  options.flat = arguments.flat == "exact" ? FlatWater::exact : arguments.flat == "auto" ? FlatWater::automatic : FlatWater::as_others;
  options.threads = common.threads;
  // A quarter of the memory is for what GDAL keeps of the input, another for the program itself.
  limit_block_cache(common.memory_bytes / 4);
  options.scratch = {common.memory_bytes / 2, std::filesystem::absolute(arguments.output).parent_path().string()};
  AtomicFile file(arguments.output, common.overwrite);
  const auto progress = make_progress(common);
  const CompressionReport report =
      compress(StoredDem(dem), header_of(dem), options, [&](std::span<const std::byte> bytes) { file.write(bytes); }, progress.get());
  file.commit();
  FileReport said = describe_compression(arguments.input, arguments.output, dem.value_type(), report);
  if (given) add_dictionary(said, report.errors, options.patches.dictionary_name, *given);
  print_result(common, said.text, said.data);
}

}  // namespace

void add_compress(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<CompressArguments>();
  CLI::App* verb = add_verb(app, "compress", "Store a DEM as a compact tree (.sct): lossless, or within an error, a PSNR or a size",
                            "arete compress dem.tif dem.sct --max-error 1\narete compress dem.tif dem.sct --psnr 60", common,
                            [arguments, common] { run_compress(*arguments, *common); });
  verb->add_option("INPUT", arguments->input, "The DEM: anything that GDAL opens")->required();
  verb->add_option("OUTPUT", arguments->output, "The tree (.sct)")->required();
  CLI::Option_group* target = verb->add_option_group("target", "What the tree must reach; one of them (default: --lossless)");
  target->add_flag("--lossless", arguments->lossless, "Every stored number comes back");
  target->add_option("--max-error", arguments->max_error, "No cell is further off than this, in metres")->check(above_zero());
  target->add_option("--rmse", arguments->rmse, "Root mean square error of at most this, in metres")->check(above_zero());
  target->add_option("--psnr", arguments->psnr, "At least this many dB, the peak being highest minus lowest elevation")->check(CLI::Range(1.0, 200.0));
  target->add_option("--bytes", arguments->bytes, "A file of at most this many bytes")->check(above_zero());
  target->add_option("--bpp", arguments->bits_per_sample, "The same in bits per cell")->check(above_zero());
  target->require_option(0, 1);
  verb->add_option("--flat", arguments->flat, "Dead-flat water (sea, lakes) of lossy trees: exact to the last bit, none (as other cells), or auto: exact where that pays")
      ->check(CLI::IsMember({"auto", "exact", "none"}))
      ->capture_default_str();
  verb->add_flag("--fast", arguments->fast, "Encode in half the time, for a file larger by 1 %");
  CLI::Option* profile = verb->add_option("--profile", arguments->profile, "best, or paper: the published model, which needs more bytes for less")
                             ->check(CLI::IsMember({"best", "paper"}));
  CLI::Option* atoms =
      verb->add_option("--atoms", arguments->patches.atoms, "Of the paper's profile: atoms of the dictionary")->check(CLI::Range(1, 65535))->needs(profile);
  verb->add_option("--sparsity", arguments->patches.sparsity, "The most coefficients of a disc")->check(CLI::Range(1, 64))->needs(profile);
  verb->add_option("--radius", arguments->radius, "Radius of a disc in cells")->check(CLI::Range(2, 32))->needs(profile);
  CLI::Option* learning =
      verb->add_option("--learning", arguments->learning, "How the dictionary is learned")->check(CLI::IsMember({"ksvd", "constrained"}))->needs(profile);
  verb->add_option("--dictionary", arguments->dictionary,
                   "Take the atoms of this dictionary, a file or the name of a shipped one, and name it in the tree instead of storing them; readers find it "
                   "beside the tree, in a folder of the environment variable ARETE_DICTIONARIES (':' between them), or among the shipped")
      ->needs(profile)->excludes(atoms)->excludes(learning);
  add_dem_options(verb, arguments->dem);
}

}  // namespace arete::tools
