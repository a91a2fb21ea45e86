#include "tools/preview_profile.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "gis/colour_ramp.h"
#include "gis/image.h"
#include "gis/terrain_profile.h"
#include "tools/elevation_input.h"

namespace arete::tools {
namespace {

struct Summary {
  double low_m = INFINITY, high_m = -INFINITY, climb_m = 0;
};

Summary summarise(const std::vector<ProfilePoint>& points) {
  Summary summary;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double here = points[i].elevation_m;
    if (std::isnan(here)) continue;
    summary.low_m = std::min(summary.low_m, here), summary.high_m = std::max(summary.high_m, here);
    if (i > 0 && here > points[i - 1].elevation_m) summary.climb_m += here - points[i - 1].elevation_m;
  }
  return summary;
}

}  // namespace

void run_preview_profile(const ProfileArguments& arguments, const CommonOptions& common) {
  check_picture_path(arguments.output, common.overwrite);
  const ElevationInput input = open_elevations(arguments.input, arguments.dem, common.threads);
  const MapLine line = arguments.line.empty() ? middle_line(input.geo, input.source->size())
                                              : MapLine{{arguments.line[0], arguments.line[1]}, {arguments.line[2], arguments.line[3]}};
  const std::vector<ProfilePoint> points = sample_profile(*input.source, input.geo, line);
  ProfileDrawing drawing;
  drawing.title = std::filesystem::path(arguments.input).filename().string();
  if (arguments.width > 0) drawing.width = arguments.width, drawing.height = arguments.width * 2 / 5;
  drawing.exaggeration = arguments.exaggeration;
  const DrawnProfile drawn = draw_profile(points, named_ramp(arguments.ramp), drawing);
  write_picture(arguments.output, drawn.picture, common.overwrite);
  const Summary summary = summarise(points);
  const double length_m = points.back().distance_m;
  print_result(common,
               fmt::format("{}: profile of {} from ({:.10g}, {:.10g}) to ({:.10g}, {:.10g}), elevations {:.1f} to {:.1f} m, climbs {:.0f} m, heights exaggerated {:g} times\n",
                           arguments.output, length_m >= 2000 ? fmt::format("{:.2f} km", length_m / 1000) : fmt::format("{:.1f} m", length_m), line.from[0],
                           line.from[1], line.to[0], line.to[1], summary.low_m, summary.high_m, summary.climb_m, drawn.exaggeration),
               {{"picture", arguments.output}, {"width", drawn.picture.width()}, {"height", drawn.picture.height()}, {"length_m", length_m}, {"low_m", summary.low_m},
                {"high_m", summary.high_m}, {"climb_m", summary.climb_m}, {"exaggeration", drawn.exaggeration}});
}

}  // namespace arete::tools
