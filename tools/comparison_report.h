#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/terrain/compare.h"
#include "core/terrain/spectrum.h"

namespace arete::tools {

/// What a comparison was of, for its report.
struct ComparisonSubject {
  std::string reference, result;   ///< as the user named them
  CellSize cell;
  int factor = 0;                  ///< 0: not given
  std::vector<std::string> notes;
};

/// The comparison in the words of a geographer, several lines.
std::string describe_comparison(const ComparisonSubject& subject, const Comparison& comparison, const SpectrumComparison& spectra);

/// The same as data. What has no value (the PSNR of identical rasters, ratios to nothing) is null.
nlohmann::json comparison_json(const ComparisonSubject& subject, const Comparison& comparison, const SpectrumComparison& spectra);

}  // namespace arete::tools
