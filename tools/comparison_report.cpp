#include "tools/comparison_report.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace arete::tools {
namespace {

#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
std::string
print(const char* format, ...) {
  char text[1024];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

/// Four significant digits, without an exponent where a reader expects none: 0.0123, 6.097, 1234.
std::string number(double value) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return "infinite";
  if (value == 0) return "0";
  const int digits = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (digits < -4) return print("%.1e", value);
  return print("%.*f", std::max(0, 3 - digits), value);
}

std::string metres(double value) { return std::isnan(value) ? "none" : number(value) + " m"; }

nlohmann::json finite(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

std::string height_lines(const Comparison& c) {
  std::string text = "Height error (result minus reference)\n";
  text += print("  RMSE               %s\n", metres(c.rmse_m).c_str());
  text += print("  PSNR               %s   (peak %s, the range of the reference)\n",
                std::isinf(c.psnr_db)   ? "infinite: the heights are identical"
                : std::isnan(c.psnr_db) ? "none"
                                        : print("%.2f dB", c.psnr_db).c_str(),
                metres(c.peak_m).c_str());
  text += print("  bias (mean)        %s\n", metres(c.bias_m).c_str());
  text += print("  mean |error|       %s\n", metres(c.mae_m).c_str());
  text += print("  |error| within     %s (50 %%)   %s (90 %%, LE90)   %s (95 %%)   %s (99 %%)\n", metres(c.p50_m).c_str(),
                metres(c.p90_m).c_str(), metres(c.p95_m).c_str(), metres(c.p99_m).c_str());
  text += print("  largest |error|    %s at column %lld, row %lld\n", metres(c.max_m).c_str(), static_cast<long long>(c.max_x),
                static_cast<long long>(c.max_y));
  return text;
}

std::string shape_lines(const Comparison& c) {
  const auto degrees = [](double value) { return std::isnan(value) ? "none" : print("%.2f degrees", value); };
  std::string text = "Shape\n";
  text += "  slope RMSE         " + degrees(c.slope_rmse_deg) + "\n";
  text += "  aspect RMSE        " + degrees(c.aspect_rmse_deg) + " (where both slope by 2 degrees or more)\n";
  text += print("  hypsometric integral  reference %s, result %s\n", number(c.integral_reference).c_str(),
                number(c.integral_result).c_str());
  text += "  heights, sorted, differ by " + metres(c.wasserstein_m) + " on average (Wasserstein distance)\n";
  return text;
}

std::string detail_lines(const ComparisonSubject& subject, const SpectrumComparison& spectra) {
  std::string text = "Detail: power of the result over power of the reference\n";
  if (spectra.tile == 0) return text + "  none: no square of 16 x 16 cells without voids\n";
  const double cell = std::sqrt(subject.cell.x_m * subject.cell.y_m);
  for (const BandPower& band : spectra.bands)
    text += print("  waves of %s to %s cells (%s to %s)   %s\n", print("%.3g", 1 / band.upper).c_str(),
                  print("%.3g", 1 / band.lower).c_str(), print("%.3g", cell / band.upper).c_str(),
                  (print("%.3g", cell / band.lower) + " m").c_str(), number(band.ratio()).c_str());
  text += print("  from %lld tiles of %lld x %lld cells, %.0f %% of the cells\n", static_cast<long long>(spectra.tiles),
                static_cast<long long>(spectra.tile), static_cast<long long>(spectra.tile), 100 * spectra.coverage);
  return text;
}

}  // namespace

std::string describe_comparison(const ComparisonSubject& subject, const Comparison& c, const SpectrumComparison& spectra) {
  std::string text = "reference  " + subject.reference + "\nresult     " + subject.result + "\n";
  text += print("compared   %lld cells of %.4g x %.4g m", static_cast<long long>(c.cells), subject.cell.x_m, subject.cell.y_m);
  if (c.only_reference > 0) text += print("; %lld more only in the reference", static_cast<long long>(c.only_reference));
  if (c.only_result > 0) text += print("; %lld more only in the result", static_cast<long long>(c.only_result));
  text += "\n";
  for (const std::string& note : subject.notes) text += "note       " + note + "\n";
  text += "\n" + height_lines(c) + "\n" + shape_lines(c) + "\n";
  if (c.consistency_m)
    text += print("Consistency at factor %d: area averages of both differ by %s RMS (%lld blocks)\n\n", subject.factor,
                  metres(*c.consistency_m).c_str(), static_cast<long long>(c.consistency_blocks));
  return text + detail_lines(subject, spectra);
}

nlohmann::json comparison_json(const ComparisonSubject& subject, const Comparison& c, const SpectrumComparison& spectra) {
  nlohmann::json bands = nlohmann::json::array();
  for (const BandPower& band : spectra.bands)
    bands.push_back({{"lower_cycles_per_cell", band.lower}, {"upper_cycles_per_cell", band.upper},
                     {"reference_power_m2", band.reference}, {"result_power_m2", band.result}, {"ratio", finite(band.ratio())}});
  nlohmann::json data = {
      {"reference", subject.reference},
      {"result", subject.result},
      {"notes", subject.notes},
      {"cell_size_m", {subject.cell.x_m, subject.cell.y_m}},
      {"cells", {{"compared", c.cells}, {"only_reference", c.only_reference}, {"only_result", c.only_result}}},
      {"height", {{"rmse_m", finite(c.rmse_m)}, {"psnr_db", finite(c.psnr_db)}, {"peak_m", finite(c.peak_m)},
                  {"identical", c.cells > 0 && c.max_m == 0}, {"bias_m", finite(c.bias_m)}, {"mean_absolute_m", finite(c.mae_m)},
                  {"percentiles_m", {{"p50", finite(c.p50_m)}, {"p90", finite(c.p90_m)}, {"p95", finite(c.p95_m)}, {"p99", finite(c.p99_m)}}},
                  {"largest_m", finite(c.max_m)}}},
      {"slope", {{"cells", c.slope_cells}, {"rmse_deg", finite(c.slope_rmse_deg)}}},
      {"aspect", {{"cells", c.aspect_cells}, {"rmse_deg", finite(c.aspect_rmse_deg)}}},
      {"hypsometry", {{"integral_reference", finite(c.integral_reference)}, {"integral_result", finite(c.integral_result)},
                      {"wasserstein_m", finite(c.wasserstein_m)}}},
      {"spectrum", {{"tile_cells", spectra.tile}, {"tiles", spectra.tiles}, {"coverage", spectra.coverage}, {"bands", bands}}},
  };
  if (c.cells > 0) data["height"]["largest_at"] = {{"column", c.max_x}, {"row", c.max_y}};
  if (c.consistency_m)
    data["consistency"] = {{"factor", subject.factor}, {"rmse_m", finite(*c.consistency_m)}, {"blocks", c.consistency_blocks}};
  return data;
}

}  // namespace arete::tools
