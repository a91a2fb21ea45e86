#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/terrain/surface.h"
#include "gis/crs.h"
#include "gis/geodesy.h"
#include "tools/command.h"
#include "tools/dem_options.h"
#include "tools/elevation_input.h"
#include "tools/verbs.h"

namespace arete::tools {
namespace {

struct SampleArguments {
  std::string input, points;
  std::vector<double> point, profile;
  int steps = 100;
  bool lonlat = false, cells = false;
  DemReadOptions dem;
};

using Place = std::array<double, 2>;

// The numbers of a line, between commas, semicolons or blanks; empty where it holds anything else among the first two.
std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  const char* at = line.data();
  const char* const end = at + line.size();
  while (numbers.size() < 2) {
    while (at < end && (*at == ',' || *at == ';' || *at == ' ' || *at == '\t' || *at == '"')) ++at;
    double value = 0;
    const auto [after, error] = std::from_chars(at, end, value);
    if (error != std::errc() || after == at) return {};
    numbers.push_back(value);
    at = after;
  }
  return numbers;
}

std::vector<Place> read_points(const std::string& path) {
  std::ifstream file;
  if (path != "-") {
    file.open(path);
    if (!file) throw Error(ErrorKind::input, "cannot read '" + path + "': no such file, or not readable");
  }
  std::istream& in = path == "-" ? std::cin : file;
  std::vector<Place> places;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r" || line[0] == '#') continue;
    const std::vector<double> numbers = numbers_of(line);
    if (numbers.size() == 2)
      places.push_back({numbers[0], numbers[1]});
    else if (number > 1)  // the first line may name the columns
      throw Error(ErrorKind::input, fmt::format("'{}', line {}: two numbers expected, as in 'x,y', found '{}'", path, number, line.substr(0, 40)));
  }
  return places;
}

std::vector<Place> places_of(const SampleArguments& arguments) {
  if (!arguments.points.empty()) return read_points(arguments.points);
  std::vector<Place> places;
  for (std::size_t i = 0; i + 1 < arguments.point.size(); i += 2) places.push_back({arguments.point[i], arguments.point[i + 1]});
  if (arguments.profile.size() == 4)
    for (int i = 0; i <= arguments.steps; ++i) {
      const double t = static_cast<double>(i) / arguments.steps;
      places.push_back({arguments.profile[0] + t * (arguments.profile[2] - arguments.profile[0]),
                        arguments.profile[1] + t * (arguments.profile[3] - arguments.profile[1])});
    }
  return places;
}

// Columns and rows of places in the coordinates of the raster.
std::vector<Place> cells_of(std::vector<Place> places, const GeoReference& geo, const SampleArguments& arguments) {
  if (arguments.cells) return places;
  if (!geo.transform) {
    if (arguments.lonlat) throw Error(ErrorKind::input, "'" + arguments.input + "' has no georeference: --lonlat cannot be placed on it; give --cells");
    return places;
  }
  if (arguments.lonlat) places = from_longitude_latitude(places, geo.crs_wkt, arguments.input);
  const auto& t = *geo.transform;
  if (t[1] * t[5] == t[2] * t[4]) throw Error(ErrorKind::input, "'" + arguments.input + "' has a transform that cannot be inverted");
  for (Place& place : places) place = cell_at(t, place[0], place[1]);
  return places;
}

void run_sample(const SampleArguments& arguments, const CommonOptions& common) {
  limit_block_cache(common.memory_bytes / 4);
  const ElevationInput input = open_elevations(arguments.input, arguments.dem, common.threads);
  const std::vector<Place> places = places_of(arguments);
  const std::vector<Place> cells = cells_of(places, input.geo, arguments);
  const CellSize cell = cell_size(input.geo, input.source->size());
  SurfaceSampler surface(*input.source);
  std::string text = "x,y,elevation_m,slope_x,slope_y\n";
  nlohmann::json data = nlohmann::json::array();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const SurfacePoint point = surface.at(cells[i][0], cells[i][1]);
    const double slope_x = point.per_cell_x / cell.x_m, slope_y = point.per_cell_y / cell.y_m;
    if (common.json) {
      data.push_back({{"x", places[i][0]}, {"y", places[i][1]}});
      if (!std::isnan(point.elevation_m)) data.back().update({{"elevation_m", point.elevation_m}, {"slope_x", slope_x}, {"slope_y", slope_y}});
      continue;
    }
    text += std::isnan(point.elevation_m) ? fmt::format("{},{},,,\n", places[i][0], places[i][1])
                                          : fmt::format("{},{},{:.4f},{:.5f},{:.5f}\n", places[i][0], places[i][1], point.elevation_m, slope_x, slope_y);
  }
  print_result(common, text, data);
}

}  // namespace

void add_sample(CLI::App& app, std::shared_ptr<CommonOptions> common) {
  const auto arguments = std::make_shared<SampleArguments>();
  CLI::App* verb = add_verb(app, "sample", "Elevations and slopes at points or along a profile, of a DEM or a tree (.sct)",
                            "arete sample dem.sct --point 2780000 1190000\narete sample dem.sct --points summits.csv --lonlat\n"
                            "arete sample dem.tif --profile 9.8 46.8 9.9 46.7 --steps 200",
                            common, [arguments, common] { run_sample(*arguments, *common); });
  verb->add_option("INPUT", arguments->input, "A tree (.sct), or a DEM that GDAL opens")->required();
  CLI::Option_group* where = verb->add_option_group("where", "In the coordinates of the raster's CRS, unless told otherwise; one of them");
  where->add_option("--point", arguments->point, "x y, any number of times")->expected(2)->allow_extra_args(false)->take_all();
  where->add_option("--points", arguments->points, "A file of lines 'x,y'; - reads them from standard input");
  where->add_option("--profile", arguments->profile, "x y of the start, x y of the end")->expected(4);
  where->require_option(1);
  verb->add_option("--steps", arguments->steps, "Parts of the profile")->check(CLI::Range(1, 10000000))->capture_default_str();
  verb->add_flag("--lonlat", arguments->lonlat, "The points are longitude and latitude in degrees on WGS 84");
  verb->add_flag("--cells", arguments->cells, "The points are columns and rows; the centre of the first cell is 0.5 0.5")->excludes("--lonlat");
  add_dem_options(verb, arguments->dem);
  verb->footer("Prints x, y, the elevation in metres and the slope towards east-going columns and south-going rows (rise over run);\n"
               "nothing where void or outside.");
}

}  // namespace arete::tools
