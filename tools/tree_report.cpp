#include "tools/tree_report.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/support/error.h"
#include "gis/crs.h"

namespace arete::tools {
namespace {

std::string_view name_of_coder(TreeCoder coder) {
  switch (coder) {
    case TreeCoder::wavelet: return "wavelet";
    case TreeCoder::predictive: return "predictive";
    case TreeCoder::patches: break;
  }
  return "patches";
}

std::string_view name_of_claim(TreeClaim claim) {
  switch (claim) {
    case TreeClaim::lossless: return "lossless";
    case TreeClaim::max_error: return "max_error";
    case TreeClaim::psnr: return "psnr";
    case TreeClaim::rmse: return "rmse";
    case TreeClaim::bytes: return "bytes";
    case TreeClaim::none: break;
  }
  return "none";
}

}  // namespace

std::string describe_claim(const TreeHeader& header) {
  switch (header.claim) {
    case TreeClaim::lossless: return "lossless: every stored number comes back";
    case TreeClaim::max_error: return fmt::format("no cell is further off than {} m", header.claimed);
    case TreeClaim::psnr: return fmt::format("PSNR of {} dB at least", header.claimed);
    case TreeClaim::rmse: return fmt::format("RMSE of {} m at most", header.claimed);
    case TreeClaim::bytes: return fmt::format("{:.0f} bytes at most", header.claimed);
    case TreeClaim::none: break;
  }
  return "none";
}

FileReport describe_errors(const std::string& input, const std::string& output, ValueType type, const TreeErrors& report) {
  const double raw = static_cast<double>(report.cells) * bytes_of(type);
  FileReport said;
  said.text = fmt::format("{}: {}, {:.4g} bits per cell, {:.4g} times smaller than the cells of '{}' ({})\n", output,
                          readable_bytes(static_cast<std::int64_t>(report.bytes)), report.bits_per_sample(), raw / static_cast<double>(report.bytes),
                          input, name_of(type));
  if (report.rmse_m == 0)
    said.text += "every stored number comes back\n";
  else
    said.text += fmt::format("PSNR {:.2f} dB (peak {:.6g} m), RMSE {:.4g} m, largest error {:.4g} m\n", report.psnr_db(), report.highest_m - report.lowest_m,
                             report.rmse_m, report.max_error_m);
  said.data = {{"output", output},
               {"bytes", report.bytes},
               {"cells", report.cells},
               {"valid_cells", report.valid_cells},
               {"bits_per_sample", report.bits_per_sample()},
               {"rmse_m", report.rmse_m},
               {"max_error_m", report.max_error_m},
               {"peak_m", report.highest_m - report.lowest_m}};
  if (report.rmse_m > 0) said.data["psnr_db"] = report.psnr_db();
  return said;
}

FileReport describe_compression(const std::string& input, const std::string& output, ValueType type, const CompressionReport& report) {
  FileReport said = describe_errors(input, output, type, report.errors);
  said.data["coder"] = std::string(name_of_coder(report.coder));
  if (!report.value_ratio) return said;
  said.text += fmt::format("value ratio of the paper: {:.2f} % by its formula, {:.2f} % as its table counts\n", 100 * report.value_ratio->printed,
                           100 * report.value_ratio->tabulated);
  said.data["value_ratio_printed"] = report.value_ratio->printed;
  said.data["value_ratio_tabulated"] = report.value_ratio->tabulated;
  return said;
}

void add_dictionary(FileReport& said, const TreeErrors& errors, const std::string& digest, const FoundDictionary& dictionary) {
  const std::uint64_t both = errors.bytes + dictionary.bytes;
  const double bits = 8 * static_cast<double>(both) / static_cast<double>(errors.cells);
  said.text += fmt::format("with the dictionary that it needs, '{}' ({}): {}, {:.4g} bits per cell\n", dictionary.path, digest,
                           readable_bytes(static_cast<std::int64_t>(both)), bits);
  said.data.update({{"dictionary", digest},
                    {"dictionary_file", dictionary.path},
                    {"dictionary_bytes", dictionary.bytes},
                    {"bytes_with_dictionary", both},
                    {"bits_per_sample_with_dictionary", bits}});
}

namespace {

// Where the dictionary is that a tree names, if it names one.
void add_named_dictionary(FileReport& said, const std::string& path, const TreeFile& file) {
  if (file.header().coder != TreeCoder::patches) return;
  const std::string digest = named_dictionary(file.header().parameters);
  if (digest.empty()) return;
  const std::optional<FoundDictionary> found = find_dictionary(digest, path);
  said.data["dictionary"] = digest;
  if (!found) {
    said.text += fmt::format("needs the dictionary {}, which is in none of the folders that are searched\n", digest);
    return;
  }
  said.text += fmt::format("needs the dictionary {}: '{}', {}\n", digest, found->path, readable_bytes(static_cast<std::int64_t>(found->bytes)));
  said.data.update({{"dictionary_file", found->path}, {"dictionary_bytes", found->bytes}, {"bytes_with_dictionary", file.bytes() + found->bytes}});
}

}  // namespace

FileReport describe_tree(const InfoOptions& options, const CommonOptions&) {
  const TreeFile file(open_bytes(options.file), options.file);
  const TreeHeader& header = file.header();
  const NodeGrid& grid = header.grid;
  const Size size = grid.size();
  FileReport said;
  said.text = fmt::format("{}: tree of {} x {} cells ({}), {}, {:.4g} bits per cell\n", options.file, size.width, size.height, name_of(header.type),
                          readable_bytes(static_cast<std::int64_t>(file.bytes())), 8 * static_cast<double>(file.bytes()) / static_cast<double>(size.cells()));
  said.text += fmt::format("coder: {}, levels 0 to {}, {} nodes of {} x {} cells{}\n", name_of_coder(header.coder), grid.levels(), file.nodes().size(),
                           grid.side(), grid.side(), header.voids ? ", with voids" : "");
  const bool flat = header.coder == TreeCoder::wavelet && decode_wavelet_parameters(header.parameters, grid, options.file).flat;
  if (flat) said.text += "flat water is exact\n";
  said.text += "claim: " + describe_claim(header) + "\n";
  if (header.geo.transform) {
    const auto& t = *header.geo.transform;
    said.text += fmt::format("origin {:.10g}, {:.10g}; cell {:.10g} x {:.10g}\n", t[0], t[3], t[1], t[5]);
  }
  said.text += "CRS: " + (header.geo.crs_wkt.empty() ? "unknown" : summarise_crs(expand_crs(header.geo.crs_wkt)).name) + "\n";
  said.data = {{"kind", "tree"},
               {"flat_water_exact", flat},
               {"file", options.file},
               {"bytes", file.bytes()},
               {"width", size.width},
               {"height", size.height},
               {"type", std::string(name_of(header.type))},
               {"coder", std::string(name_of_coder(header.coder))},
               {"levels", grid.levels() + 1},
               {"nodes", file.nodes().size()},
               {"node_side", grid.side()},
               {"voids", header.voids},
               {"claim", std::string(name_of_claim(header.claim))},
               {"scale", header.scale},
               {"offset", header.offset},
               {"vertical_unit", header.geo.vertical_unit},
               {"crs_wkt", expand_crs(header.geo.crs_wkt)},
               {"band_name", header.band_name},
               {"metadata", header.metadata}};
  if (header.claim > TreeClaim::lossless) said.data["claimed"] = header.claimed;
  if (header.geo.transform) said.data["transform"] = *header.geo.transform;
  if (header.geo.nodata) said.data["nodata"] = *header.geo.nodata;
  add_named_dictionary(said, options.file, file);
  return said;
}

}  // namespace arete::tools
