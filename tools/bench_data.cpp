#include "tools/bench_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace arete::tools {
namespace {

const char* kind_name(CodingTarget::Kind kind) {
  switch (kind) {
    case CodingTarget::Kind::lossless: return "lossless";
    case CodingTarget::Kind::max_error: return "max_error_m";
    case CodingTarget::Kind::bytes: return "bytes";
    case CodingTarget::Kind::setting: return "setting";
  }
  return "";
}

std::string quote_csv(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_number(double value, const char* format = "%.9g") {
  if (!std::isfinite(value)) return value > 0 ? "inf" : "";
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string measured_row(const std::string& start, const std::string& what, const Measurement& m) {
  const std::string target = m.target.kind == CodingTarget::Kind::lossless ? "" : csv_number(m.target.value);
  return start + what + "," + kind_name(m.target.kind) + "," + target + "," + std::to_string(m.bytes) + "," + csv_number(m.bits) + "," +
         csv_number(m.psnr_db, "%.4f") + "," + csv_number(m.rmse_m) + "," + csv_number(m.max_error_m) + "," + csv_number(m.encode_s, "%.4f") + "," +
         csv_number(m.decode_s, "%.4f") + "," + (kept(m) ? "yes" : "no") + "\n";
}

nlohmann::json number_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json measurement_json(const Measurement& m) {
  nlohmann::json data = {{"target", kind_name(m.target.kind)}, {"bytes", m.bytes}, {"bits_per_sample", m.bits},
                         {"rmse_m", number_or_null(m.rmse_m)}, {"psnr_db", number_or_null(m.psnr_db)}, {"max_error_m", number_or_null(m.max_error_m)},
                         {"exact", m.max_error_m == 0}, {"kept", kept(m)}, {"encode_s", m.encode_s}, {"decode_s", m.decode_s}};
  if (m.target.kind != CodingTarget::Kind::lossless) data["value"] = m.target.value;
  return data;
}

nlohmann::json trial_json(const BenchedDem& dem, const CodecTrial& trial) {
  nlohmann::json data = {{"codec", trial.name}, {"title", trial.title}, {"description", trial.description}, {"keeps_voids", trial.keeps_voids}};
  data["curve"] = data["rates"] = data["bounds"] = nlohmann::json::array();
  for (const Measurement& m : trial.curve) data["curve"].push_back(measurement_json(m));
  for (const auto& reading : trial.rates)
    data["rates"].push_back(!reading ? nlohmann::json()
                                     : nlohmann::json{{"bits_per_sample", reading->rate}, {"psnr_db", reading->psnr_db},
                                                      {"max_error_m", reading->max_error_m}, {"encode_s", reading->encode_s}, {"decode_s", reading->decode_s}});
  const auto promised = [&](const std::optional<Measurement>& made, std::optional<std::size_t> bound) {
    if (!made) return nlohmann::json();
    nlohmann::json entry = measurement_json(*made);
    entry["bytes_over_best_other_percent"] = number_or_null(percent_over_best_other(dem, trial, bound));
    return entry;
  };
  for (std::size_t i = 0; i < trial.bounds.size(); ++i) data["bounds"].push_back(promised(trial.bounds[i], i));
  data["lossless"] = promised(trial.lossless, std::nullopt);
  const GainOverAnchor gain = gain_over_anchor(dem, trial);
  data["over_anchor"] = {{"mean_gain_db", number_or_null(gain.mean_db)}, {"bd_psnr_db", number_or_null(gain.bd_psnr_db)},
                         {"bd_rate_percent", number_or_null(gain.bd_rate_percent)}};
  return data;
}

nlohmann::json paper_json(const PaperRow& row) {
  return {{"atoms", paper_atoms}, {"sparsity", row.sparsity}, {"value_ratio_formula", row.ratio.printed}, {"value_ratio_table", row.ratio.tabulated},
          {"tree", measurement_json(row.tree)}, {"jpeg2000", measurement_json(row.jpeg2000)}};
}

/// A table for a terminal: a head, and a row of cells per codec.
std::string text_table(const std::vector<CodecTrial>& trials, const std::string& head, const std::vector<std::string>& columns,
                       const std::function<std::vector<std::string>(const CodecTrial&)>& cells) {
  std::size_t widest = head.size();
  for (const CodecTrial& trial : trials) widest = std::max(widest, trial.title.size());
  const auto line = [&](const std::string& first, const std::vector<std::string>& rest) {
    std::string text = "  " + first + std::string(widest - first.size(), ' ');
    for (const std::string& cell : rest) text += "  " + std::string(cell.size() < 8 ? 8 - cell.size() : 0, ' ') + cell;
    return text + "\n";
  };
  std::string text = line(head, columns);
  for (const CodecTrial& trial : trials) text += line(trial.title, cells(trial));
  return text + "\n";
}

std::string paper_text(const std::vector<PaperRow>& rows) {
  std::string text = "  paper's profile, " + std::to_string(paper_atoms) + " atoms: ";
  for (const std::string& column : paper_columns) text += (&column == &paper_columns.front() ? "" : " | ") + column;
  text += "\n";
  for (const PaperRow& row : rows) {
    std::string line;
    for (const std::string& cell : paper_cells(row)) line += (line.empty() ? "    " : " | ") + cell;
    text += line + "\n";
  }
  return text + "\n";
}

std::vector<std::string> plain_numbers(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(format_plain(value));
  return texts;
}

}  // namespace

const CodecTrial* anchor_trial(const BenchedDem& dem) {
  const auto found = std::find_if(dem.trials.begin(), dem.trials.end(), [](const CodecTrial& trial) { return trial.name == "openjpeg"; });
  return found == dem.trials.end() ? nullptr : &*found;
}

GainOverAnchor gain_over_anchor(const BenchedDem& dem, const CodecTrial& trial) {
  const CodecTrial* anchor = anchor_trial(dem);
  if (anchor == nullptr || anchor == &trial) return {};
  const std::vector<RatePoint> from = anchor->points(), to = trial.points();
  return {mean_gain(*anchor, trial, gain_lowest_rate, gain_highest_rate), bd_psnr(from, to), bd_rate(from, to)};
}

std::optional<double> percent_over_best_other(const BenchedDem& dem, const CodecTrial& trial, std::optional<std::size_t> bound) {
  const auto bytes_of = [&](const CodecTrial& one) -> std::optional<double> {
    const std::optional<Measurement>& made = bound ? one.bounds.at(*bound) : one.lossless;
    return made && kept(*made) ? std::optional(static_cast<double>(made->bytes)) : std::nullopt;
  };
  std::optional<double> best;
  for (const CodecTrial& other : dem.trials)
    if (const auto bytes = bytes_of(other); &other != &trial && bytes && (!best || *bytes < *best)) best = bytes;
  const std::optional<double> own = bytes_of(trial);
  return own && best ? std::optional(100 * (*own / *best - 1)) : std::nullopt;
}

std::string format_value(const std::optional<double>& value, int decimals, const std::string& missing) {
  if (!value || std::isnan(*value)) return missing;
  if (std::isinf(*value)) return "exact";
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, *value);
  return text;
}

std::string format_plain(double value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string bench_csv(const std::vector<BenchedDem>& dems) {
  std::string text = "dem,codec,result,target,value,bytes,bits_per_sample,psnr_db,rmse_m,max_error_m,encode_s,decode_s,kept\n";
  for (const BenchedDem& dem : dems)
    for (const CodecTrial& trial : dem.trials) {
      const std::string start = quote_csv(dem.label) + "," + trial.name + ",";
      for (const Measurement& m : trial.curve) text += measured_row(start, "point", m);
      for (const auto& reading : trial.rates)
        if (reading)
          text += start + "rate,bits_per_sample," + csv_number(reading->rate) + ",," + csv_number(reading->rate) + "," + csv_number(reading->psnr_db, "%.4f") +
                  ",," + csv_number(reading->max_error_m) + "," + csv_number(reading->encode_s, "%.4f") + "," + csv_number(reading->decode_s, "%.4f") + ",\n";
      for (const auto& bound : trial.bounds)
        if (bound) text += measured_row(start, "bound", *bound);
      if (trial.lossless) text += measured_row(start, "lossless", *trial.lossless);
    }
  return text;
}

std::string paper_csv(const std::vector<BenchedDem>& dems) {
  std::string text = "dem,atoms,sparsity,value_ratio_formula,value_ratio_table,bytes,bits_per_sample,psnr_db,jpeg2000_bytes,jpeg2000_psnr_db,encode_s,decode_s\n";
  for (const BenchedDem& dem : dems)
    for (const PaperRow& row : dem.paper)
      text += quote_csv(dem.label) + "," + std::to_string(paper_atoms) + "," + std::to_string(row.sparsity) + "," + csv_number(row.ratio.printed) + "," +
              csv_number(row.ratio.tabulated) + "," + std::to_string(row.tree.bytes) + "," + csv_number(row.tree.bits) + "," +
              csv_number(row.tree.psnr_db, "%.4f") + "," + std::to_string(row.jpeg2000.bytes) + "," + csv_number(row.jpeg2000.psnr_db, "%.4f") + "," +
              csv_number(row.tree.encode_s, "%.4f") + "," + csv_number(row.tree.decode_s, "%.4f") + "\n";
  return text;
}

nlohmann::json bench_json(const std::vector<BenchedDem>& dems) {
  nlohmann::json all = nlohmann::json::array();
  for (const BenchedDem& dem : dems) {
    nlohmann::json data = {{"dem", dem.path}, {"label", dem.label}, {"width", dem.size.width}, {"height", dem.size.height}, {"valid_cells", dem.valid},
                           {"lowest_m", dem.low_m}, {"highest_m", dem.high_m}, {"peak_m", dem.high_m - dem.low_m},
                           {"quantum_m", dem.quantum_m > 0 ? nlohmann::json(dem.quantum_m) : nlohmann::json()},
                           {"rates_bits_per_sample", dem.plan.rates}, {"bounds_m", dem.plan.bounds_m}, {"repeats", dem.plan.repeats}, {"threads", dem.plan.threads}};
    const CodecTrial* anchor = anchor_trial(dem);
    data["anchor"] = anchor != nullptr ? nlohmann::json(anchor->name) : nlohmann::json();
    data["codecs"] = nlohmann::json::array();
    for (const CodecTrial& trial : dem.trials) data["codecs"].push_back(trial_json(dem, trial));
    data["paper"] = nlohmann::json::array();
    for (const PaperRow& row : dem.paper) data["paper"].push_back(paper_json(row));
    all.push_back(data);
  }
  return {{"dems", all}, {"mean_gain_rates_bits_per_sample", {gain_lowest_rate, gain_highest_rate}}};
}

std::vector<std::string> paper_cells(const PaperRow& row) {
  return {std::to_string(row.sparsity), format_value(100 * row.ratio.printed, 1) + " %", format_value(100 * row.ratio.tabulated, 1) + " %",
          std::to_string(row.tree.bytes), format_value(row.tree.bits, 3), format_value(row.tree.psnr_db, 2), std::to_string(row.jpeg2000.bytes),
          format_value(row.jpeg2000.psnr_db, 2), format_value(row.tree.psnr_db - row.jpeg2000.psnr_db, 2), format_value(row.tree.encode_s, 1)};
}

std::string bench_text(const std::vector<BenchedDem>& dems) {
  std::string text;
  for (const BenchedDem& dem : dems) {
    text += dem.path + ": " + std::to_string(dem.size.width) + " x " + std::to_string(dem.size.height) + " cells, " + format_plain(dem.low_m) + " to " +
            format_plain(dem.high_m) + " m\n\n";
    if (!dem.plan.rates.empty()) {
      std::vector<std::string> columns = plain_numbers(dem.plan.rates);
      columns.push_back("gain");
      text += text_table(dem.trials, "PSNR in dB at bits per sample", columns, [&](const CodecTrial& trial) {
        std::vector<std::string> cells;
        for (const auto& reading : trial.rates) cells.push_back(format_value(reading ? std::optional(reading->psnr_db) : std::nullopt, 2));
        const std::optional<double> gain = gain_over_anchor(dem, trial).mean_db;
        cells.push_back((gain && *gain >= 0 ? "+" : "") + format_value(gain, 2));
        return cells;
      });
    }
    if (!dem.plan.bounds_m.empty())
      text += text_table(dem.trials, "bits per sample within m", plain_numbers(dem.plan.bounds_m), [](const CodecTrial& trial) {
        std::vector<std::string> cells;
        for (const auto& bound : trial.bounds) cells.push_back(!bound ? "-" : kept(*bound) ? format_value(bound->bits, 3) : "broken");
        return cells;
      });
    if (dem.plan.lossless)
      text += text_table(dem.trials, "lossless", {"bits", "bytes", "encode s", "decode s"}, [](const CodecTrial& trial) -> std::vector<std::string> {
        if (!trial.lossless) return {"-", "-", "-", "-"};
        const Measurement& m = *trial.lossless;
        return {kept(m) ? format_value(m.bits, 3) : "broken", std::to_string(m.bytes), format_value(m.encode_s, 2), format_value(m.decode_s, 2)};
      });
    if (!dem.paper.empty()) text += paper_text(dem.paper);
  }
  return text;
}

}  // namespace arete::tools
