#include "gis/relief.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/support/parallel.h"
#include "core/terrain/hillshade.h"
#include "core/terrain/overview.h"
#include "core/terrain/sea.h"
#include "core/terrain/slope.h"
#include "core/terrain/statistics.h"
#include "gis/colour_ramp.h"
#include "gis/contour_lines.h"
#include "gis/drape_picture.h"
#include "gis/legend.h"

namespace arete {
namespace {

constexpr std::int64_t longest_map = 2048, longest_magnified = 1024, panel_width = 512, narrowest = 460;
constexpr double light_altitude_deg = 45;
constexpr Colour water_colour = {168, 199, 220, 255}, void_colour = {0, 0, 0, 0};

/// Pixels of the map and what one of them is on the ground.
struct Layout {
  Size pixels;
  double metres_per_pixel = 1;
};

Layout plan(Size size, CellSize cell, std::int64_t width) {
  const double wide = static_cast<double>(size.width) * cell.x_m, high = static_cast<double>(size.height) * cell.y_m;
  const double coarsest = std::max(cell.x_m, cell.y_m), longest = std::max(wide, high);
  double metres = coarsest;
  if (width > 0) {
    const double factor = std::floor(static_cast<double>(width) * coarsest / wide);
    metres = factor >= 1 ? coarsest / factor : wide / static_cast<double>(width);
  } else if (longest > longest_map * coarsest) {
    metres = longest / longest_map;
  } else {
    metres = coarsest / std::max(1.0, std::floor(longest_magnified * coarsest / longest));
  }
  const auto pixels = [metres](double length) { return std::max<std::int64_t>(1, std::llround(length / metres)); };
  return {{pixels(wide), pixels(high)}, metres};
}

/// Heights at the resolution of the drawing, and which of them are water.
struct Ground {
  Overview overview;
  CellSize cell;
  Raster<std::uint8_t> water;
};

Ground survey_blocks(const RasterSource& source, CellSize cell, std::int64_t across, std::int64_t down, int threads, Progress& progress) {
  Ground ground;
  ground.overview = make_overview(source, across, down, threads, progress);
  ground.cell = {cell.x_m * static_cast<double>(across), cell.y_m * static_cast<double>(down)};
  ground.water = find_sea(ground.overview.cells.view());
  return ground;
}

Ground survey(const RasterSource& source, CellSize cell, Size pixels, int threads, Progress& progress) {
  const Size size = source.size();
  const std::int64_t across = std::max<std::int64_t>(1, size.width / pixels.width);
  const std::int64_t down = std::max<std::int64_t>(1, size.height / pixels.height);
  return survey_blocks(source, cell, across, down, threads, progress);
}

/// What the panels of a picture share.
struct Scale {
  double low = 0, high = 1;            // of the colours
  double low_m = 0, high_m = 0;        // of the elevations
  double exaggeration = 1;
  bool voids = false, water = false;
  double steepest_deg = 90;            // of the colours of slopes
};

/// The percentile of the slopes of the land, metres per metre; the largest of the grounds.
double steepness_of(const std::vector<Ground>& grounds, double share) {
  double steepest = 0;
  for (const Ground& ground : grounds) {
    const RasterView<const float> cells = ground.overview.cells.view();
    std::vector<float> slopes;
    for (std::int64_t y = 0; y < cells.height; ++y)
      for (std::int64_t x = 0; x < cells.width; ++x) {
        if (ground.water(x, y)) continue;
        if (const auto g = horn_gradient(cells, x, y, ground.cell)) slopes.push_back(static_cast<float>(std::hypot(g->east, g->north)));
      }
    if (!slopes.empty()) steepest = std::max(steepest, percentile(slopes, share));
  }
  return steepest;
}

Scale common_scale(const std::vector<Ground>& grounds, double exaggeration) {
  Scale scale;
  std::vector<float> land;
  double low = INFINITY, high = -INFINITY;
  for (const Ground& ground : grounds) {
    const Overview& overview = ground.overview;
    for (std::int64_t i = 0; i < overview.cells.size().cells(); ++i) {
      const float z = overview.cells.data()[i];
      scale.voids |= is_void(z);
      if (ground.water.data()[i])
        scale.water = true;
      else if (!is_void(z))
        land.push_back(z);
    }
    if (overview.valid > 0) low = std::min(low, overview.low_m), high = std::max(high, overview.high_m);
  }
  scale.low_m = low <= high ? low : std::nan("");
  scale.high_m = low <= high ? high : std::nan("");
  scale.low = land.empty() ? scale.low_m : percentile(land, 0.001);
  scale.high = land.empty() ? scale.high_m : percentile(land, 0.999);
  scale.exaggeration = exaggeration > 0 ? exaggeration : exaggeration_for(steepness_of(grounds, 0.9), 30, 12);
  return scale;
}

/// A colour under a light, 1 being that of flat ground: shadows fall off towards a cool dark, lit slopes towards white.
Colour lit(Colour colour, double light, double strength) {
  constexpr double shadow[3] = {0.10, 0.12, 0.22};
  const double brightest = 1 / std::sin(light_altitude_deg * M_PI / 180);
  Colour result = colour;
  for (std::size_t c = 0; c < 3; ++c) {
    const double own = colour[c];
    double value = own;
    if (light < 1)
      value = own * (1 - strength * (1 - (shadow[c] + (1 - shadow[c]) * light)));
    else
      value = own + (255 - own) * strength * 0.75 * (light - 1) / (brightest - 1);
    result[c] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
  }
  return result;
}

Raster<float> light_of(const Ground& ground, double exaggeration, const ReliefOptions& options) {
  const Raster<float>& cells = ground.overview.cells;
  Raster<float> light(cells.width(), cells.height());
  HillshadeOptions shading;
  shading.exaggeration = exaggeration;
  shading.altitude_deg = light_altitude_deg;
  shading.azimuth_deg = options.azimuth_deg;
  hillshade(cells.view(), {0, 0, cells.width(), cells.height()}, ground.cell, shading, light.view(), options.threads);
  return light;
}

/// On hatched ground, so that void cells (transparent until here) show it.
Picture finish_map(const Picture& cells, Size pixels) {
  Picture map = hatching(pixels.width, pixels.height);
  paste(map, resize_picture(cells, pixels.width, pixels.height), 0, 0);
  return map;
}

/// `colour_at(i)` is the colour of cell i under even light.
template <typename ColourAt>
Picture paint(const Ground& ground, const Raster<float>& light, double strength, int threads, const ColourAt& colour_at) {
  const Size size = ground.overview.cells.size();
  const double flat = std::sin(light_altitude_deg * M_PI / 180);
  Picture picture(size.width, size.height, void_colour);
  parallel_for(size.height, threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < size.width; ++x) {
      const std::int64_t i = y * size.width + x;
      const Colour colour = colour_at(i);
      picture(x, y) = colour[3] == 0 ? void_colour : lit(colour, static_cast<double>(light.data()[i]) / flat, strength);
    }
  });
  return picture;
}

/// Slopes or aspects by their colours.
Picture paint_gradients(const Ground& ground, const Scale& scale, const ReliefOptions& options) {
  const bool slopes = options.style.colour == GroundColour::slope;
  const ColourRamp ramp = slopes ? slope_ramp() : aspect_ramp();
  const Colour flat = flat_colour();
  const RasterView<const float> cells = ground.overview.cells.view();
  // Light tells less than the colours here.
  return paint(ground, light_of(ground, scale.exaggeration, options), 0.7, options.threads, [&](std::int64_t i) {
    if (is_void(cells.data[i])) return void_colour;
    if (ground.water.data()[i]) return water_colour;
    const auto gradient = horn_gradient(cells, i % cells.width, i / cells.width, ground.cell);
    if (!gradient) return flat;
    const double share = slope_deg(*gradient) / scale.steepest_deg;
    if (slopes) return ramp.at(share);
    const double t = std::clamp((share - flat_share) / (facing_share - flat_share), 0.0, 1.0), facing = t * t * (3 - 2 * t);
    Colour colour = ramp.at(aspect_deg(*gradient) / 360);
    for (std::size_t c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>(std::lround(flat[c] + facing * (colour[c] - flat[c])));
    return colour;
  });
}

Picture paint_relief(const Ground& ground, const Scale& scale, const ReliefOptions& options) {
  const ColourRamp ramp = named_ramp(options.ramp);
  const double span = scale.high > scale.low ? scale.high - scale.low : 1;
  return paint(ground, light_of(ground, scale.exaggeration, options), 1, options.threads, [&](std::int64_t i) {
    const float z = ground.overview.cells.data()[i];
    if (is_void(z)) return void_colour;
    if (ground.water.data()[i]) return water_colour;
    return ramp.at((static_cast<double>(z) - scale.low) / span);
  });
}

/// Void pixels take the mean colour of the valid ones beside them, ring by ring; far inside a void they are grey.
Picture spread_colours(Picture picture) {
  constexpr int rings = 4;
  constexpr Colour far_inside = {190, 190, 190, 255};
  const std::int64_t width = picture.width(), height = picture.height();
  for (int ring = 0; ring < rings; ++ring) {
    const Picture before = picture;
    for (std::int64_t y = 0; y < height; ++y)
      for (std::int64_t x = 0; x < width; ++x) {
        if (before(x, y)[3] != 0) continue;
        int sum[3] = {}, count = 0;
        for (std::int64_t j = std::max<std::int64_t>(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
          for (std::int64_t i = std::max<std::int64_t>(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
            if (before(i, j)[3] == 0) continue;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += before(i, j)[c];
            ++count;
          }
        if (count == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) picture(x, y)[c] = static_cast<std::uint8_t>(sum[c] / count);
        picture(x, y)[3] = 255;
      }
  }
  for (std::int64_t i = 0; i < width * height; ++i)
    if (picture.data()[i][3] == 0) picture.data()[i] = far_inside;
  return picture;
}

std::string range_text(double low, double high) {
  if (std::isnan(low)) return "no elevation";
  char text[96];
  const int decimals = high - low >= 20 ? 0 : high - low >= 2 ? 1 : 2;
  std::snprintf(text, sizeof text, "%.*f to %.*f m", decimals, low, decimals, high);
  return text;
}

Legend relief_legend(const Scale& scale, double metres_per_pixel, const ReliefOptions& options) {
  Legend legend;
  legend.title = "Elevation, " + range_text(scale.low_m, scale.high_m);
  legend.low = scale.low;
  legend.high = scale.high;
  legend.metres_per_pixel = options.metric ? metres_per_pixel : 0;
  style_legend(legend, options.style, scale.steepest_deg);
  if (scale.water) legend.swatches.push_back({Picture(1, 1, water_colour), "water"});
  if (scale.voids) legend.swatches.push_back({hatching(40, 20), "no data"});
  char note[80];
  if (scale.exaggeration != 1) {
    std::snprintf(note, sizeof note, "relief exaggerated %g times", scale.exaggeration);
    legend.note += (legend.note.empty() ? "" : "; ") + std::string(note);
  }
  return legend;
}

Picture add_legend(const Picture& map, const Legend& legend, const ColourRamp& ramp) {
  return stack(map, draw_legend(legend, ramp, std::max(map.width(), narrowest)));
}

}  // namespace

namespace {

/// Lays the picture over a map of the whole DEM, under the light of the ground.
void lay_over(Picture& map, const DrapePicture& drape, const Ground& ground, Size dem, double exaggeration, const ReliefOptions& options) {
  constexpr int even = 200;
  const Raster<float> light = light_of(ground, exaggeration, options);
  const Picture shades = resize_picture(paint(ground, light, 0.5, options.threads, [](std::int64_t) { return Colour{even, even, even, 255}; }), map.width(), map.height());
  const double across = static_cast<double>(dem.width) / static_cast<double>(map.width()), down = static_cast<double>(dem.height) / static_cast<double>(map.height());
  const Picture& from = drape.picture;
  parallel_for(map.height(), options.threads, [&](std::int64_t y) {
    for (std::int64_t x = 0; x < map.width(); ++x) {
      const double u = ((static_cast<double>(x) + 0.5) * across - drape.left) / drape.width * static_cast<double>(from.width());
      const double v = ((static_cast<double>(y) + 0.5) * down - drape.top) / drape.height * static_cast<double>(from.height());
      if (!(u >= 0 && v >= 0 && u < static_cast<double>(from.width()) && v < static_cast<double>(from.height()))) continue;
      // Bilinear, of colours times opacity.
      double sum[4] = {};
      for (int k = 0; k < 4; ++k) {
        const double column = std::floor(u - 0.5) + k % 2, row = std::floor(v - 0.5) + k / 2;
        const double weight = (1 - std::abs(u - 0.5 - column)) * (1 - std::abs(v - 0.5 - row));
        const Colour& pixel = from(std::clamp<std::int64_t>(static_cast<std::int64_t>(column), 0, from.width() - 1),
                                   std::clamp<std::int64_t>(static_cast<std::int64_t>(row), 0, from.height() - 1));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * pixel[c] * pixel[3] / 255;
        sum[3] += weight * pixel[3] / 255;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const double shade = static_cast<double>(shades(x, y)[c]) / even;
        map(x, y)[c] = static_cast<std::uint8_t>(std::clamp(std::lround(sum[c] * shade + map(x, y)[c] * (1 - sum[3])), 0L, 255L));
      }
    }
  });
}

}  // namespace

Relief draw_relief(const RasterSource& source, CellSize cell, const ReliefOptions& options, Progress& progress) {
  const Layout layout = plan(source.size(), cell, options.width);
  const ColourRamp ramp = named_ramp(options.ramp);
  std::vector<Ground> grounds;
  grounds.push_back(survey(source, cell, layout.pixels, options.threads, progress));
  Scale scale = common_scale(grounds, options.exaggeration);
  ReliefOptions settled = options;
  settled.style = settle(options.style, scale.high_m - scale.low_m);
  const GroundStyle& style = settled.style;
  if (style.colour != GroundColour::height) scale.steepest_deg = slope_scale_deg(std::atan(steepness_of(grounds, 0.99)) * 180 / M_PI);
  const Picture cells = style.colour == GroundColour::height ? paint_relief(grounds[0], scale, settled) : paint_gradients(grounds[0], scale, settled);
  Relief relief{finish_map(cells, layout.pixels), scale.low_m, scale.high_m, scale.exaggeration, layout.metres_per_pixel, style.contour_interval_m};
  Legend legend = relief_legend(scale, layout.metres_per_pixel, settled);
  std::optional<DrapePicture> drape;
  if (options.cover) {
    drape = read_drape(options.cover->path, options.cover->dem, {.per_cell = static_cast<double>(layout.pixels.width) / static_cast<double>(source.size().width)});
    lay_over(relief.picture, *drape, grounds[0], source.size(), scale.exaggeration, options);
    drape_legend(legend, *drape, options.cover->path);
  }
  if (style.contour_interval_m > 0)
    draw_contours(relief.picture, grounds[0].overview.cells.view(), std::as_const(grounds[0].water).view(), style.contour_interval_m, options.threads);
  if (options.legend && !find_font().empty())
    relief.picture = add_legend(relief.picture, legend, ramp_of(style.colour, ramp));
  if (options.legend && !find_font().empty() && drape && drape->values)
    relief.picture = add_legend(relief.picture, value_legend(*drape, options.cover->path), named_ramp("viridis"));
  return relief;
}

Relief draw_relief_panels(const std::vector<ReliefPanel>& panels, int columns, const ReliefOptions& options, Progress& progress) {
  assert(!panels.empty());
  const ReliefPanel& first = panels.front();
  const double wide = static_cast<double>(first.source->size().width) * first.cell.x_m;
  const double high = static_cast<double>(first.source->size().height) * first.cell.y_m;
  const std::int64_t width = options.width > 0 ? options.width : panel_width;
  const double metres = wide / static_cast<double>(width);
  const Size pixels{width, std::max<std::int64_t>(1, std::llround(high / metres))};
  std::vector<Ground> grounds;
  for (const ReliefPanel& panel : panels) grounds.push_back(survey(*panel.source, panel.cell, pixels, options.threads, progress));
  const Scale scale = common_scale(grounds, options.exaggeration);

  const auto count = static_cast<std::int64_t>(panels.size()), across = columns > 0 ? std::min<std::int64_t>(columns, count) : count;
  const std::int64_t rows = (count + across - 1) / across, gap = 10;
  const int font = std::clamp(static_cast<int>(width / 26), 13, 26);
  const std::int64_t head = 2 * font;
  Picture sheet(across * width + (across + 1) * gap, rows * (head + pixels.height + gap));
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t x = gap + i % across * (width + gap), y = i / across * (head + pixels.height + gap);
    draw_text(sheet, x, y + head - font / 2, panels[static_cast<std::size_t>(i)].caption, font, {45, 45, 48, 255});
    paste(sheet, finish_map(paint_relief(grounds[static_cast<std::size_t>(i)], scale, options), pixels), x, y + head);
  }
  if (options.legend && !find_font().empty()) sheet = add_legend(sheet, relief_legend(scale, metres, options), named_ramp(options.ramp));
  return {std::move(sheet), scale.low_m, scale.high_m, scale.exaggeration, metres};
}

namespace {

/// result - reference, void where either is.
class DifferenceSource final : public RasterSource {
 public:
  DifferenceSource(const RasterSource& reference, const RasterSource& result) : reference_(reference), result_(result) {}
  Size size() const override { return reference_.size(); }
  void read(const Window& window, RasterView<float> out) const override {
    Raster<float> reference(window.width, window.height);
    reference_.read(window, reference.view());
    result_.read(window, out);
    for (std::int64_t y = 0; y < window.height; ++y)
      for (std::int64_t x = 0; x < window.width; ++x) out(x, y) -= reference(x, y);
  }

 private:
  const RasterSource &reference_, &result_;
};

}  // namespace

Drapes drape_reliefs(const std::vector<ReliefPanel>& panels, std::int64_t longest, const ReliefOptions& options, Progress& progress) {
  assert(!panels.empty() && longest > 0);
  std::vector<Ground> grounds;
  for (const ReliefPanel& panel : panels) {
    const Size size = panel.source->size();
    const std::int64_t block = (std::max(size.width, size.height) + longest - 1) / longest;
    grounds.push_back(survey_blocks(*panel.source, panel.cell, block, block, options.threads, progress));
  }
  const Scale scale = common_scale(grounds, options.exaggeration);
  Drapes result;
  result.colour_low_m = scale.low;
  result.colour_high_m = scale.high;
  result.exaggeration = scale.exaggeration;
  result.water = scale.water;
  for (Ground& ground : grounds) {
    Picture picture = spread_colours(paint_relief(ground, scale, options));
    result.drapes.push_back({std::move(picture), std::move(ground.overview)});
  }
  return result;
}

Relief draw_difference_map(const RasterSource& reference, const RasterSource& result, CellSize cell, double limit_m,
                           const ReliefOptions& options, Progress& progress) {
  assert(reference.size() == result.size());
  const Layout layout = plan(reference.size(), cell, options.width);
  std::vector<Ground> grounds;
  grounds.push_back(survey(reference, cell, layout.pixels, options.threads, progress));
  const Ground difference = survey(DifferenceSource(reference, result), cell, layout.pixels, options.threads, progress);
  const Scale scale = common_scale(grounds, options.exaggeration);
  const ColourRamp ramp = difference_ramp();
  const double limit = limit_m > 0 ? limit_m : 1;
  bool voids = false;
  const Picture cells = paint(grounds[0], light_of(grounds[0], scale.exaggeration, options), 0.3, options.threads, [&](std::int64_t i) {
    const float error = difference.overview.cells.data()[i];
    return is_void(error) || is_void(grounds[0].overview.cells.data()[i]) ? void_colour
                                                                         : ramp.at(0.5 + static_cast<double>(error) / limit / 2);
  });
  for (std::int64_t i = 0; i < cells.width() * cells.height(); ++i) voids |= cells.data()[i][3] == 0;
  Relief map{finish_map(cells, layout.pixels), difference.overview.low_m, difference.overview.high_m, scale.exaggeration,
             layout.metres_per_pixel};
  if (!options.legend || find_font().empty()) return map;
  Legend legend;
  legend.title = "Result minus reference, " + range_text(map.low_m, map.high_m);
  legend.low = -limit;
  legend.high = limit;
  legend.metres_per_pixel = options.metric ? layout.metres_per_pixel : 0;
  if (voids) legend.swatches.push_back({hatching(40, 20), "no data"});
  legend.note = "blue: too low, red: too high";
  map.picture = add_legend(map.picture, legend, ramp);
  return map;
}

}  // namespace arete
