#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "core/sparse/dictionary_file.h"
#include "core/support/file.h"
#include "gis/contact_sheet.h"
#include "tools/info.h"

namespace arete::tools {
namespace {

using nlohmann::json;

constexpr const char* method_names[] = {"all", "ksvd", "constrained"};
constexpr const char* method_words[] = {"all patches", "K-SVD", "constrained: every atom is a real patch"};

/// Text of a file on a terminal: what would steer the terminal is shown as '?'.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

json exemplars_of(const Dictionary& dictionary) {
  std::vector<std::int64_t> atoms(dictionary.exemplars.size(), 0);
  for (const AtomSource& source : dictionary.sources)
    if (source.exemplar >= 0) ++atoms[static_cast<std::size_t>(source.exemplar)];
  json list = json::array();
  for (std::size_t i = 0; i < atoms.size(); ++i) list.push_back({{"name", dictionary.exemplars[i]}, {"atoms", atoms[i]}});
  return list;
}

json to_json(const std::string& path, std::size_t file_bytes, const Dictionary& d) {
  const auto count_sources = [&](auto&& is_counted) { return std::count_if(d.sources.begin(), d.sources.end(), is_counted); };
  json data = {{"kind", "dictionary"},
               {"file", path},
               {"bytes", file_bytes},
               {"digest", dictionary_digest(d)},
               {"method", method_names[static_cast<int>(d.method)]},
               {"atoms", d.atoms()},
               {"patch_cells", d.patch_cells},
               {"factor", d.factor},
               {"has_high", d.high.size() > 0},
               {"has_detail", d.detail.size() > 0},
               {"cell_size_m", nullptr},
               {"radius_m", nullptr},
               {"upsampler", nullptr},
               {"detail_power", d.detail_power},
               {"coarse_detail_power", d.coarse_detail_power},
               {"exemplars", exemplars_of(d)},
               {"atoms_without_source", count_sources([](const AtomSource& s) { return s.exemplar < 0; })},
               {"atoms_turned", count_sources([](const AtomSource& s) { return s.symmetry != 0; })},
               {"provenance", d.provenance},
               {"sheet", nullptr}};
  if (d.cell_size_m > 0) {
    data["cell_size_m"] = d.cell_size_m;
    data["radius_m"] = d.cell_size_m * d.patch_cells / 2;
  }
  if (d.upsampler) data["upsampler"] = {{"factor", d.upsampler->factor}, {"reach", d.upsampler->reach}};
  return data;
}

std::string atoms_text(const Dictionary& d) {
  std::string text = fmt::format("{} of {} x {} cells", d.atoms(), d.patch_cells, d.patch_cells);
  const int fine = d.patch_cells * d.factor;
  if (d.high.size() > 0) text += fmt::format(", and {} times finer: {} x {}", d.factor, fine, fine);
  if (d.detail.size() > 0) text += d.high.size() > 0 ? ", with detail" : fmt::format(", and detail of {} x {}", fine, fine);
  return text;
}

std::string radius_text(const Dictionary& d) {
  if (d.cell_size_m == 0) return fmt::format("{} cells; their size is not known", d.patch_cells / 2);
  return fmt::format("{:.6g} m, {} cells of {:.6g} m", d.cell_size_m * d.patch_cells / 2, d.patch_cells / 2, d.cell_size_m);
}

std::string to_text(const json& data, const Dictionary& d) {
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += fmt::format("{:<14} {}\n", label, value); };
  line("File", data["file"]);
  line("Format", "dictionary (.atoms), " + readable_bytes(data["bytes"]));
  line("Digest", data["digest"]);
  line("Method", method_words[static_cast<int>(d.method)]);
  line("Atoms", atoms_text(d));
  line("Radius", radius_text(d));
  for (const json& exemplar : data["exemplars"])
    line("Exemplar", fmt::format("{}: {} atoms", printable(exemplar["name"]), exemplar["atoms"].get<std::int64_t>()));
  if (data["atoms_without_source"] != 0)
    line("No exemplar", fmt::format("{} atoms", data["atoms_without_source"].get<std::int64_t>()));
  if (data["atoms_turned"] != 0)
    line("Turned", fmt::format("{} atoms are rotated or mirrored", data["atoms_turned"].get<std::int64_t>()));
  if (d.upsampler)
    line("Upsampler", fmt::format("{} times, from {} x {} cells", d.upsampler->factor, d.upsampler->side(), d.upsampler->side()));
  else
    line("Upsampler", "none: only for --method paper");
  if (d.detail.size() > 0)
    line("Detail power",
         fmt::format("{:.4g}{}", d.detail_power,
                     d.coarse_detail_power > 0 ? fmt::format(", one factor coarser {:.4g}", d.coarse_detail_power) : ""));
  line("Provenance", d.provenance.empty() ? "not stated" : printable(d.provenance));
  if (!data["sheet"].is_null()) line("Sheet", data["sheet"]);
  return text;
}

void write_sheet(const InfoOptions& options, const Dictionary& dictionary, const CommonOptions& common) {
  if (find_font().empty()) warn(common, "no font found, the caption is left out: install fonts-dejavu-core or set ARETE_FONT");
  const std::int64_t shown = std::min(dictionary.atoms(), most_sheet_atoms);
  const std::string count = shown < dictionary.atoms() ? fmt::format("the first {} of {} atoms", shown, dictionary.atoms())
                                                       : fmt::format("{} atoms", shown);
  const std::string caption =
      fmt::format("{}: {} of {} x {} cells{}; each in colours and light of its own relief",
                  std::filesystem::path(options.file).filename().string(), count, dictionary.patch_cells, dictionary.patch_cells,
                  dictionary.high.size() > 0 ? fmt::format(", {} times finer", dictionary.factor) : "");
  write_picture(options.sheet, draw_contact_sheet(dictionary, caption), common.overwrite);
}

}  // namespace

FileReport describe_dictionary(const InfoOptions& options, const CommonOptions& common) {
  if (!options.sheet.empty()) check_picture_path(options.sheet, common.overwrite);
  const std::vector<std::byte> bytes = read_file(options.file);
  const Dictionary dictionary = decode_dictionary(bytes, options.file);
  json data = to_json(options.file, bytes.size(), dictionary);
  if (!options.sheet.empty()) {
    write_sheet(options, dictionary, common);
    data["sheet"] = options.sheet;
  }
  return {to_text(data, dictionary), data};
}

}  // namespace arete::tools
