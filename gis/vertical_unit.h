#pragma once

#include <string>

namespace arete {

/// The unit of elevations.
struct VerticalUnit {
  std::string name = "m";  ///< as the file names it
  double metres = 1;       ///< one unit in metres
  bool known = true;       ///< false: the name is not known, and the unit was taken as the metre
  bool stated = false;     ///< false: neither the band nor the CRS states a unit
};

/// The unit of a band's elevations: from the unit that the band names (metres, feet, US survey feet, and decimal parts of the
/// metre, in the usual spellings); where it names none, from the vertical axis of the CRS; else the metre.
VerticalUnit vertical_unit(const std::string& band_unit, const std::string& crs_wkt);

}  // namespace arete
