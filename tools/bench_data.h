#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gis/compression_trial.h"
#include "gis/paper_trial.h"

namespace arete::tools {

/// What the codecs did to one DEM.
struct BenchedDem {
  std::string path = {};   ///< as the user named it
  std::string label = {};  ///< unique among the DEMs of a run; names its plots
  Size size = {};
  std::int64_t valid = 0;
  double low_m = 0, high_m = 0, quantum_m = 0;
  TrialPlan plan = {};
  std::vector<CodecTrial> trials = {};
  std::vector<PaperRow> paper = {};  ///< empty: not asked for
};

/// The codec that the others are held against, or nullptr where it did not take part.
const CodecTrial* anchor_trial(const BenchedDem& dem);

/// The rates between which the mean gain is taken, bits per sample.
inline constexpr double gain_lowest_rate = 0.05, gain_highest_rate = 2;

/// A codec against the anchor.
struct GainOverAnchor {
  std::optional<double> mean_db;  ///< over the rates asked for within gain_lowest_rate..gain_highest_rate that both reach
  std::optional<double> bd_psnr_db, bd_rate_percent;
};
GainOverAnchor gain_over_anchor(const BenchedDem& dem, const CodecTrial& trial);

/// By how many percent the bytes of a trial are more (above 0) or fewer (below 0) than those of the best other codec that kept the same
/// promise: at the bound of that index, or lossless where it is nullopt. Nullopt where there is no other, or the trial has not kept it.
std::optional<double> percent_over_best_other(const BenchedDem& dem, const CodecTrial& trial, std::optional<std::size_t> bound);

/// "12.34", or `missing` where there is no number, "exact" where it is infinite.
std::string format_value(const std::optional<double>& value, int decimals, const std::string& missing = "-");

/// A number as short as it can be told from others: "0.05", "20".
std::string format_plain(double value);

/// One row per measurement and per reading of a curve. Lines end in a line feed; text with commas or quotes is quoted (RFC 4180).
std::string bench_csv(const std::vector<BenchedDem>& dems);

/// A row for each DEM and sparsity of the paper's profile; only the head where it was not asked for.
std::string paper_csv(const std::vector<BenchedDem>& dems);

/// The same and more as data; what is infinite or missing is null.
nlohmann::json bench_json(const std::vector<BenchedDem>& dems);

/// The columns of the table of the paper's profile, and a row of it.
inline const std::vector<std::string> paper_columns = {"s", "rho by formula", "rho as tabulated", "bytes", "bits per sample", "PSNR dB",
                                                       "JPEG 2000 bytes", "its PSNR dB", "difference dB", "s to encode"};
std::vector<std::string> paper_cells(const PaperRow& row);

/// Tables for a terminal.
std::string bench_text(const std::vector<BenchedDem>& dems);

}  // namespace arete::tools
