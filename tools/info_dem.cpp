#include <cmath>

#include <fmt/format.h>

#include "core/terrain/statistics.h"
#include "gis/crs.h"
#include "tools/info.h"

namespace arete::tools {
namespace {

using nlohmann::json;

std::string either(const std::string& text, const char* otherwise) { return text.empty() ? otherwise : text; }

std::string with_authority(const std::string& name, const std::string& authority) {
  return authority.empty() ? name : name + " (" + authority + ")";
}

/// JSON has no NaN.
json number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

/// Width and height of a cell in the units of the transform.
CellSize cell_in_file_units(const GeoReference& geo) {
  if (!geo.transform) return {1, 1};
  const auto& t = *geo.transform;
  return {std::hypot(t[1], t[4]), std::hypot(t[2], t[5])};
}

/// The items that Arete wrote when it made the file.
json making_of(const DemDescription& about) {
  json items = json::object();
  for (const auto& [name, value] : about.metadata)
    if (name.rfind("ARETE_", 0) == 0 || name == "TIFFTAG_SOFTWARE") items[name] = value;
  return items;
}

json to_json(const DemReader& dem, const CrsSummary& crs, const ElevationStatistics& z) {
  const GeoReference& geo = dem.georeference();
  const DemDescription& about = dem.description();
  const CellSize in_units = cell_in_file_units(geo), in_metres = dem.cell_size();
  json data = {{"kind", "dem"},
               {"file", dem.path()},
               {"driver", about.driver},
               {"data_type", about.data_type},
               {"width", dem.size().width},
               {"height", dem.size().height},
               {"bands", about.band_names},
               {"transform", geo.transform ? json(*geo.transform) : json()},
               {"south_up", about.south_up},
               {"cell_size", {{"x", in_units.x_m}, {"y", in_units.y_m}, {"unit", crs.unit}}},
               {"cell_size_m", {{"x", in_metres.x_m}, {"y", in_metres.y_m}}},
               {"registration", geo.registration == Registration::point ? "point" : "area"},
               {"crs", {{"name", crs.name}, {"authority", crs.authority}, {"wkt", geo.crs_wkt}}},
               {"vertical_crs", {{"name", crs.vertical_name}, {"authority", crs.vertical_authority}}},
               {"vertical_unit", {{"name", geo.vertical_unit}, {"metres", geo.metres_per_unit}, {"stated", about.unit_stated},
                                  {"known", about.unit_known}}},
               {"scale", about.scale},
               {"offset", about.offset},
               {"nodata", geo.nodata ? number(*geo.nodata) : json()},
               {"masked", about.masked},
               {"cells", z.cells},
               {"valid_cells", z.valid},
               {"void_share", z.void_share()},
               {"elevation_m", nullptr},
               {"extent_wgs84", nullptr},
               {"made_by", making_of(about)}};
  if (z.valid > 0) data["elevation_m"] = {{"min", z.lowest}, {"max", z.highest}, {"mean", z.mean}, {"std", z.deviation}};
  if (const auto extent = geographic_extent(geo, dem.size()))
    data["extent_wgs84"] = {{"west", extent->west}, {"south", extent->south}, {"east", extent->east}, {"north", extent->north}};
  return data;
}

std::string nodata_text(const json& data) {
  const std::string share = fmt::format("{:.4g} % of the cells void", 100 * data["void_share"].get<double>());
  const json& nodata = data["nodata"];
  const std::string declared = nodata.is_null() ? "none declared" : nodata.is_string() ? nodata.get<std::string>()
                                                                                        : fmt::format("{:.9g}", nodata.get<double>());
  return declared + (data["masked"].get<bool>() ? ", a mask" : "") + "; " + share;
}

std::string unit_text(const json& data) {
  const json& unit = data["vertical_unit"];
  const auto name = unit["name"].get<std::string>();
  if (!unit["known"].get<bool>()) return "'" + name + "' is not known, taken as metres";
  const double metres = unit["metres"];
  if (!unit["stated"].get<bool>()) return name + " (not stated, assumed)";
  return metres == 1 ? name : fmt::format("{} ({:.10g} m)", name, metres);
}

std::string elevation_text(const json& elevation) {
  if (elevation.is_null()) return "none: every cell is void";
  return fmt::format("{:.3f} .. {:.3f} m, mean {:.3f} m, standard deviation {:.3f} m", elevation["min"].get<double>(),
                     elevation["max"].get<double>(), elevation["mean"].get<double>(), elevation["std"].get<double>());
}

std::string extent_text(const json& extent) {
  if (extent.is_null()) return "unknown";
  const auto degrees = [](double value, const char* positive, const char* negative) {
    return fmt::format("{:.6f} {}", std::fabs(value), value < 0 ? negative : positive);
  };
  return degrees(extent["west"], "E", "W") + " .. " + degrees(extent["east"], "E", "W") + ", " +
         degrees(extent["south"], "N", "S") + " .. " + degrees(extent["north"], "N", "S");
}

std::string cell_text(const json& data) {
  const json &cell = data["cell_size"], &metres = data["cell_size_m"];
  const std::string unit = either(cell["unit"].get<std::string>(), data["transform"].is_null() ? "cell" : "unit");
  const std::string in_metres = fmt::format("{:.6g} x {:.6g} m", metres["x"].get<double>(), metres["y"].get<double>());
  if (unit == "metre") return in_metres;
  const std::string in_units = fmt::format("{:.9g} x {:.9g} {}", cell["x"].get<double>(), cell["y"].get<double>(), unit);
  return in_units + (data["crs"]["name"].get<std::string>().empty() ? ", taken as " : ", at the centre ") + in_metres;
}

std::string to_text(const json& data) {
  std::string text;
  const auto line = [&](const char* label, const std::string& value) { text += fmt::format("{:<14} {}\n", label, value); };
  const auto words = [&](const char* key) {
    const auto name = data[key]["name"].get<std::string>();
    return with_authority(name, data[key]["authority"].get<std::string>());
  };
  line("File", data["file"]);
  line("Format", fmt::format("{}, {}", data["driver"].get<std::string>(), data["data_type"].get<std::string>()));
  line("Size", fmt::format("{} x {} cells", data["width"].get<std::int64_t>(), data["height"].get<std::int64_t>()));
  std::string bands;
  for (const auto& band : data["bands"]) bands += (bands.empty() ? "" : ", ") + either(band.get<std::string>(), "unnamed");
  line("Bands", fmt::format("{} ({})", data["bands"].size(), bands));
  line("Cell", cell_text(data));
  line("Registration", "pixel is " + data["registration"].get<std::string>() +
                           (data["south_up"].get<bool>() ? "; rows run from south to north (read as north up)" : ""));
  line("CRS", either(words("crs"), "unknown"));
  line("Vertical CRS", either(words("vertical_crs"), "not stated"));
  line("Unit", unit_text(data));
  if (data["scale"] != 1.0 || data["offset"] != 0.0)
    line("Scale", fmt::format("{:.9g} x stored + {:.9g}", data["scale"].get<double>(), data["offset"].get<double>()));
  line("Nodata", nodata_text(data));
  line("Elevation", elevation_text(data["elevation_m"]));
  line("Extent", extent_text(data["extent_wgs84"]));
  for (const auto& [name, value] : data["made_by"].items()) line(name.c_str(), value.get<std::string>());
  return text;
}

}  // namespace

FileReport describe_dem(const InfoOptions& options, const CommonOptions& common) {
  const DemReader dem(options.file, options.dem);
  const auto progress = make_progress(common);
  const ElevationStatistics elevations = elevation_statistics(dem, *progress);
  const json data = to_json(dem, summarise_crs(dem.georeference().crs_wkt), elevations);
  return {to_text(data), data};
}

}  // namespace arete::tools
