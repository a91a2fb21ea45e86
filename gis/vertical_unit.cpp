#include "gis/vertical_unit.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include <ogr_spatialref.h>

#include "gis/gdal_errors.h"

namespace arete {
namespace {

constexpr double foot_m = 0.3048;                     // international foot, 1959
constexpr double us_survey_foot_m = 1200.0 / 3937.0;  // Mendenhall order, 1893

/// Lower case, letters and digits only: "US survey foot" and "us_survey_foot" are one name.
std::string plain(const std::string& name) {
  std::string result;
  for (char c : name)
    if (std::isalnum(static_cast<unsigned char>(c))) result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::optional<double> metres_of(const std::string& name) {
  struct Spelling {
    const char* name;
    double metres;
  };
  static constexpr Spelling spellings[] = {
      {"m", 1},           {"metre", 1},         {"meter", 1},        {"metres", 1},       {"meters", 1},
      {"mtr", 1},         {"km", 1000},         {"kilometre", 1000}, {"kilometer", 1000}, {"dm", 0.1},
      {"decimetre", 0.1}, {"decimeter", 0.1},   {"cm", 0.01},        {"centimetre", 0.01}, {"centimeter", 0.01},
      {"mm", 0.001},      {"millimetre", 0.001}, {"millimeter", 0.001},
      {"ft", foot_m},     {"foot", foot_m},     {"feet", foot_m},    {"internationalfoot", foot_m},
      {"footinternational", foot_m},            {"internationalfeet", foot_m},            {"intft", foot_m},
      {"usft", us_survey_foot_m},               {"ftus", us_survey_foot_m},               {"footus", us_survey_foot_m},
      {"ussurveyfoot", us_survey_foot_m},       {"ussurveyfeet", us_survey_foot_m},       {"surveyfoot", us_survey_foot_m},
      {"footussurvey", us_survey_foot_m},       {"surveyfeet", us_survey_foot_m},         {"usfoot", us_survey_foot_m}};
  const std::string wanted = plain(name);
  const auto* found = std::find_if(std::begin(spellings), std::end(spellings), [&](const Spelling& s) { return wanted == s.name; });
  if (found == std::end(spellings)) return std::nullopt;
  return found->metres;
}

std::optional<VerticalUnit> unit_of_vertical_axis(const std::string& crs_wkt) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (crs_wkt.empty() || crs.importFromWkt(crs_wkt.c_str()) != OGRERR_NONE || !crs.IsVertical()) return std::nullopt;
  const char* name = nullptr;
  const double metres = crs.GetTargetLinearUnits("VERT_CS", &name);
  if (name == nullptr || !std::isfinite(metres) || metres <= 0) return std::nullopt;
  return VerticalUnit{metres == 1 ? "m" : name, metres, true, true};
}

}  // namespace

VerticalUnit vertical_unit(const std::string& band_unit, const std::string& crs_wkt) {
  if (!band_unit.empty()) {
    if (const auto metres = metres_of(band_unit)) return {band_unit, *metres, true, true};
    return {band_unit, 1, false, true};
  }
  if (const auto unit = unit_of_vertical_axis(crs_wkt)) return *unit;
  return {};
}

}  // namespace arete
