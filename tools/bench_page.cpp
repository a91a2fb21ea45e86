#include "tools/bench_page.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace arete::tools {
namespace {

constexpr double below_anchor_db = 8;  // how far below the anchor's curve the PSNR is still shown

using Row = std::vector<std::string>;

std::string signed_value(const std::optional<double>& value, int decimals) {
  return (value && *value > 0 ? "+" : "") + format_value(value, decimals);
}

/// A table with a row per codec; codecs whose cells are all missing are left out.
Report::Section codec_table(const BenchedDem& dem, const std::string& heading, Row columns, const std::function<Row(const CodecTrial&)>& cells) {
  Report::Section section{.heading = heading, .level = 3};
  columns.insert(columns.begin(), "codec");
  section.columns = std::move(columns);
  for (const CodecTrial& trial : dem.trials) {
    Row row = cells(trial);
    if (std::all_of(row.begin(), row.end(), [](const std::string& cell) { return cell == "-"; })) continue;
    row.insert(row.begin(), trial.title);
    section.rows.push_back(std::move(row));
  }
  return section;
}

Row plain_numbers(const std::vector<double>& values, const std::string& unit) {
  Row texts;
  for (const double value : values) texts.push_back(format_plain(value) + unit);
  return texts;
}

Row readings(const CodecTrial& trial, double RateReading::*member, int decimals) {
  Row cells;
  for (const auto& reading : trial.rates) cells.push_back(format_value(reading ? std::optional(*reading.*member) : std::nullopt, decimals));
  return cells;
}

/// Decimals that show a thousandth of the relief.
int decimals_for(const BenchedDem& dem) {
  return std::clamp(static_cast<int>(std::ceil(3 - std::log10(dem.high_m - dem.low_m))) + 1, 1, 6);
}

void add_rate_tables(Report& report, const BenchedDem& dem) {
  const Row columns = plain_numbers(dem.plan.rates, " bit");
  Report::Section psnr = codec_table(dem, "PSNR in dB at bits per sample", columns, [](const CodecTrial& trial) { return readings(trial, &RateReading::psnr_db, 2); });
  psnr.svg = line_plot_svg(psnr_plot(dem));
  report.sections.push_back(std::move(psnr));
  if (anchor_trial(dem) != nullptr && dem.trials.size() > 1) {
    Report::Section gains = codec_table(dem, "Against " + anchor_trial(dem)->title, {"mean PSNR gain", "BD-PSNR", "BD-rate"}, [&](const CodecTrial& trial) -> Row {
      const GainOverAnchor gain = gain_over_anchor(dem, trial);
      const std::string rate = signed_value(gain.bd_rate_percent, 1);
      return {signed_value(gain.mean_db, 2) + (gain.mean_db ? " dB" : ""), signed_value(gain.bd_psnr_db, 2) + (gain.bd_psnr_db ? " dB" : ""), rate + (rate == "-" ? "" : " %")};
    });
    std::erase_if(gains.rows, [](const Row& row) { return row[1] == "-" && row[2] == "-" && row[3] == "-"; });
    report.sections.push_back(std::move(gains));
  }
  Report::Section errors = codec_table(dem, "Largest error in m at bits per sample", columns,
                                       [&](const CodecTrial& trial) { return readings(trial, &RateReading::max_error_m, decimals_for(dem)); });
  errors.svg = line_plot_svg(max_error_plot(dem));
  report.sections.push_back(std::move(errors));
  for (const auto& [heading, member] : {std::pair("Seconds to encode at bits per sample", &RateReading::encode_s), std::pair("Seconds to decode at bits per sample", &RateReading::decode_s)})
    report.sections.push_back(codec_table(dem, heading, columns, [member = member](const CodecTrial& trial) { return readings(trial, member, 3); }));
}

/// The first codec's bytes against the best other's: with .sct in the list that is .sct.
std::string percent_cell(const BenchedDem& dem, std::optional<std::size_t> bound) {
  const std::optional<double> percent = percent_over_best_other(dem, dem.trials.front(), bound);
  return signed_value(percent, 1) + (percent ? " %" : "");
}

/// A last row with those cells, unless there is nothing in them.
void add_share_row(Report::Section& section, const BenchedDem& dem, Row cells) {
  if (std::none_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.find('%') != std::string::npos; })) return;
  cells.insert(cells.begin(), "bytes of " + dem.trials.front().title + " against the best other");
  section.rows.push_back(std::move(cells));
}

void add_bound_table(Report& report, const BenchedDem& dem) {
  Report::Section section = codec_table(dem, "Bits per sample within a strict error", plain_numbers(dem.plan.bounds_m, " m"), [](const CodecTrial& trial) {
    Row cells;
    for (const auto& bound : trial.bounds) cells.push_back(!bound ? "-" : format_value(bound->bits, 3) + (kept(*bound) ? "" : " (broken)"));
    return cells;
  });
  Row shares;
  for (std::size_t i = 0; i < dem.plan.bounds_m.size(); ++i) shares.push_back(percent_cell(dem, i));
  add_share_row(section, dem, std::move(shares));
  section.svg = line_plot_svg(bound_plot(dem));
  report.sections.push_back(std::move(section));
}

void add_lossless_table(Report& report, const BenchedDem& dem) {
  Report::Section section = codec_table(dem, "Lossless", {"bits per sample", "bytes", "s to encode", "s to decode"}, [](const CodecTrial& trial) -> Row {
    if (!trial.lossless) return {"-"};
    const Measurement& m = *trial.lossless;
    return {format_value(m.bits, 3) + (kept(m) ? "" : " (broken)"), std::to_string(m.bytes), format_value(m.encode_s, 3), format_value(m.decode_s, 3)};
  });
  add_share_row(section, dem, {percent_cell(dem, std::nullopt), "", "", ""});
  report.sections.push_back(std::move(section));
}

void add_paper_table(Report& report, const BenchedDem& dem) {
  Report::Section section{.heading = "The published model beside JPEG 2000 in as many bytes", .level = 3};
  section.paragraphs.push_back(
      "The sparse tree of Guérin, Digne, Galin and Peytavie (2016), arete compress --profile paper, with " + std::to_string(paper_atoms) +
      " atoms learned on this DEM, which the file holds. rho is the paper's ratio of stored values to cells, by the formula it prints and as its table counts; "
      "the bytes are those of the whole file. JPEG 2000 is OpenJPEG as above, asked for the same bytes.");
  section.columns = paper_columns;
  for (const PaperRow& row : dem.paper) section.rows.push_back(paper_cells(row));
  report.sections.push_back(std::move(section));
}

void add_dem(Report& report, const BenchedDem& dem) {
  Report::Section section{.heading = dem.label};
  std::string words = dem.path + ": " + std::to_string(dem.size.width) + " x " + std::to_string(dem.size.height) + " cells, " + format_plain(dem.low_m) + " to " +
                      format_plain(dem.high_m) + " m; the peak of the PSNR is " + format_plain(dem.high_m - dem.low_m) + " m.";
  if (const std::int64_t voids = dem.size.cells() - dem.valid; voids > 0) {
    words += " " + std::to_string(voids) + " cells are void; they were filled by interpolation for the codecs that cannot store voids (";
    std::string names;
    for (const CodecTrial& trial : dem.trials)
      if (!trial.keeps_voids) names += (names.empty() ? "" : ", ") + trial.title;
    words += names + "), whose files hold no sign of where they were.";
  }
  if (dem.quantum_m > 0) words += " Every elevation is a whole multiple of " + format_plain(dem.quantum_m) + " m.";
  section.paragraphs.push_back(words);
  report.sections.push_back(section);
  if (!dem.plan.rates.empty()) add_rate_tables(report, dem);
  if (!dem.plan.bounds_m.empty()) add_bound_table(report, dem);
  if (dem.plan.lossless) add_lossless_table(report, dem);
  if (!dem.paper.empty()) add_paper_table(report, dem);
}

void add_summary(Report& report, const std::vector<BenchedDem>& dems) {
  Report::Section section{.heading = "Mean PSNR gain in dB over JPEG 2000 (OpenJPEG)"};
  section.columns = {"DEM"};
  for (const CodecTrial& trial : dems.front().trials)
    if (&trial != anchor_trial(dems.front())) section.columns.push_back(trial.title);
  if (anchor_trial(dems.front()) == nullptr || section.columns.size() < 2 || dems.front().plan.rates.empty()) return;
  for (const BenchedDem& dem : dems) {
    Row row = {dem.label};
    for (const CodecTrial& trial : dem.trials)
      if (&trial != anchor_trial(dem)) row.push_back(signed_value(gain_over_anchor(dem, trial).mean_db, 2));
    section.rows.push_back(std::move(row));
  }
  report.sections.push_back(std::move(section));
}

/// Promises that were not kept, in words; empty where all were.
std::vector<std::string> broken_promises(const std::vector<BenchedDem>& dems) {
  std::vector<std::string> broken;
  for (const BenchedDem& dem : dems)
    for (const CodecTrial& trial : dem.trials) {
      for (const auto& bound : trial.bounds)
        if (bound && !kept(*bound))
          broken.push_back(dem.label + ": " + trial.title + " was asked for " + format_plain(bound->target.value) + " m and erred by " + format_plain(bound->max_error_m) + " m.");
      if (trial.lossless && !kept(*trial.lossless)) broken.push_back(dem.label + ": " + trial.title + " lossless erred by " + format_plain(trial.lossless->max_error_m) + " m.");
    }
  return broken;
}

LinePlot start_plot(const BenchedDem& dem, const std::string& what) {
  LinePlot plot;
  plot.title = dem.label + ": " + what;
  plot.x_title = "bits per sample (all bytes of the file)";
  plot.log_x = true;
  plot.x_ticks = dem.plan.rates;
  return plot;
}

/// The colour that a codec has in all plots, whichever take part.
Colour colour_of(const CodecTrial& trial) {
  const std::vector<std::string> names = {"sct", "openjpeg", "gdal-jp2", "jpegxl", "lerc", "zstd", "deflate"};
  return plot_colour(static_cast<std::size_t>(std::find(names.begin(), names.end(), trial.name) - names.begin()));
}

/// The measured points about the rates asked for.
bool is_asked(const BenchedDem& dem, double bits) {
  const auto [least, most] = std::minmax_element(dem.plan.rates.begin(), dem.plan.rates.end());
  return bits >= 0.8 * *least && bits <= 1.25 * *most;
}

}  // namespace

LinePlot psnr_plot(const BenchedDem& dem) {
  LinePlot plot = start_plot(dem, "PSNR over rate");
  plot.y_title = "PSNR in dB";
  double highest = 0, lowest = 0;
  for (const CodecTrial& trial : dem.trials) {
    LinePlot::Series series{.name = trial.title, .colour = colour_of(trial), .strong = trial.name == "sct"};
    for (const RatePoint& point : trial.points())
      if (is_asked(dem, point.bits)) {
        series.points.emplace_back(point.bits, point.psnr);
        highest = std::max(highest, point.psnr);
      }
    if (&trial == anchor_trial(dem) && !series.points.empty()) lowest = series.points.front().second - below_anchor_db;
    plot.series.push_back(std::move(series));
  }
  if (lowest > 0 && highest > lowest) plot.y_low = lowest, plot.y_high = highest + 0.03 * (highest - lowest);
  return plot;
}

LinePlot max_error_plot(const BenchedDem& dem) {
  LinePlot plot = start_plot(dem, "largest error over rate");
  plot.y_title = "largest error in m";
  plot.log_y = true;
  plot.note = "dashed: asked for that error";
  for (const CodecTrial& trial : dem.trials) {
    LinePlot::Series series{.name = trial.title, .colour = colour_of(trial), .strong = trial.name == "sct"}, strict{.name = "", .colour = colour_of(trial), .dashed = true};
    for (const Measurement& m : trial.curve)
      if (is_asked(dem, m.bits)) series.points.emplace_back(m.bits, m.max_error_m);
    for (const auto& bound : trial.bounds)
      if (bound) strict.points.emplace_back(bound->bits, bound->max_error_m);
    if (series.points.empty() && !strict.points.empty()) strict.name = series.name;
    if (!series.points.empty()) plot.series.push_back(std::move(series));
    if (!strict.points.empty()) plot.series.push_back(std::move(strict));
  }
  return plot;
}

LinePlot bound_plot(const BenchedDem& dem) {
  LinePlot plot;
  plot.title = dem.label + ": bits per sample over strict error";
  plot.x_title = "largest error asked for in m";
  plot.y_title = "bits per sample (all bytes of the file)";
  plot.log_x = plot.log_y = true;
  for (const double bound : dem.plan.bounds_m)
    if (bound > 0) plot.x_ticks.push_back(bound);
  for (const CodecTrial& trial : dem.trials) {
    LinePlot::Series series{.name = trial.title, .colour = colour_of(trial), .strong = trial.name == "sct"};
    for (const auto& bound : trial.bounds)
      if (bound && kept(*bound)) series.points.emplace_back(bound->target.value, bound->bits);
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

Report bench_page(const std::vector<BenchedDem>& dems, const std::string& command_line) {
  Report report{.title = "Compression of terrain"};
  const TrialPlan& plan = dems.front().plan;
  report.introduction = {
      "Bits per sample are all bytes that the decoder needs, 8 times, over the cells of the raster, voids included. PSNR is 20 log10(peak / RMSE), the peak being "
      "the highest minus the lowest valid elevation. Every file was decoded again from its bytes alone; RMSE and the largest error are over the valid cells.",
      "A codec that cannot be asked for a size was run at several settings, and its curve is read at the rates of the tables, on a logarithmic axis of rates; '-' where "
      "it does not get there, or has no such mode. The mean PSNR gain is over the rates of the table from " + format_plain(gain_lowest_rate) + " to " +
          format_plain(gain_highest_rate) + " bits per sample that both codecs reach. BD-PSNR and BD-rate are Bjontegaard's mean differences (piecewise cubics on the "
          "logarithm of the rate, over the common interval): dB at equal size, and size at equal PSNR.",
      "Times are medians of " + std::to_string(plan.repeats) + (plan.repeats == 1 ? " run" : " runs") + " with " + std::to_string(plan.threads) +
          (plan.threads == 1 ? " thread" : " threads") + ", from elevations in memory to bytes in memory and back."};
  for (const std::string& words : broken_promises(dems)) report.introduction.push_back("Broken promise: " + words);
  add_summary(report, dems);
  Report::Section codecs{.heading = "Codecs"};
  codecs.columns = {"codec", "how it was used"};
  for (const CodecTrial& trial : dems.front().trials) codecs.rows.push_back({trial.title, trial.description});
  for (const BenchedDem& dem : dems) add_dem(report, dem);
  report.sections.push_back(std::move(codecs));
  report.footer = "arete " ARETE_VERSION ": " + command_line;
  return report;
}

}  // namespace arete::tools
