#include "gis/legend.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string_view>

namespace arete {
namespace {

constexpr Colour ink = {45, 45, 48, 255}, faint = {110, 110, 115, 255}, paper = {255, 255, 255, 255};

/// 1, 2 or 5 times a power of ten, not above `length`.
double round_down(double length) {
  const double power = std::pow(10, std::floor(std::log10(length) + 1e-9));
  const double digit = length / power * (1 + 1e-9);
  return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

void frame(Picture& picture, const Window& area, Colour colour) {
  fill(picture, {area.x, area.y, area.width, 1}, colour);
  fill(picture, {area.x, area.y + area.height - 1, area.width, 1}, colour);
  fill(picture, {area.x, area.y, 1, area.height}, colour);
  fill(picture, {area.x + area.width - 1, area.y, 1, area.height}, colour);
}

void draw_colour_bar(Picture& picture, const Legend& legend, const ColourRamp& ramp, const Window& bar, int font) {
  for (std::int64_t x = 0; x < bar.width; ++x)
    fill(picture, {bar.x + x, bar.y, 1, bar.height}, ramp.at((static_cast<double>(x) + 0.5) / static_cast<double>(bar.width)));
  frame(picture, bar, faint);
  const int wanted = static_cast<int>(std::clamp<std::int64_t>(bar.width / (5 * font), 2, 7));
  const std::vector<double> ticks = round_ticks(legend.low, legend.high, wanted);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : 1;
  std::vector<std::pair<double, std::string>> marks = legend.marks;
  if (marks.empty())
    for (const double tick : ticks) marks.emplace_back(tick, format_tick(tick, step) + (tick == ticks.back() && !legend.unit.empty() ? " " + legend.unit : ""));
  for (const auto& [tick, label] : marks) {
    const double share = legend.high > legend.low ? (tick - legend.low) / (legend.high - legend.low) : 0.5;
    const std::int64_t x = bar.x + std::clamp<std::int64_t>(std::lround(share * static_cast<double>(bar.width)), 0, bar.width - 1);
    fill(picture, {x, bar.y + bar.height, 1, font / 3}, ink);
    draw_text(picture, x, bar.y + bar.height + font / 3 + font, label, font, ink, Align::centre);
  }
}

/// Ends at `right`; two parts, dark and light, as on printed maps.
void draw_scale_bar(Picture& picture, double metres_per_pixel, std::int64_t right, std::int64_t y, std::int64_t longest, int font) {
  const double metres = round_length(static_cast<double>(longest) * metres_per_pixel);
  const std::int64_t length = std::max<std::int64_t>(2, std::lround(metres / metres_per_pixel));
  const std::int64_t left = right - length, high = std::max(4, font / 3);
  fill(picture, {left, y, length, high}, ink);
  fill(picture, {left + length / 2, y + 1, length - length / 2 - 1, high - 2}, paper);
  const double shown = metres >= 1000 ? metres / 1000 : metres;
  char label[64];
  std::snprintf(label, sizeof label, "%.10g %s", shown, metres >= 1000 ? "km" : "m");
  draw_text(picture, left, y + high + font / 3 + font, "0", font, ink, Align::centre);
  draw_text(picture, right, y + high + font / 3 + font, label, font, ink, Align::right);
}

/// The title of a legend of heights, to end another with.
std::string elevations_of(const Legend& legend) {
  constexpr std::string_view first = "Elevation, ";
  if (legend.title.empty()) return "";
  return " (" + (legend.title.starts_with(first) ? "elevation " + legend.title.substr(first.size()) : legend.title) + ")";
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int wanted) {
  if (!(high > low)) return {low};
  double step = round_down((high - low) / wanted);
  // Rounding down may give up to 2.5 times too many.
  while ((high - low) / step > 1.5 * wanted) step = round_down(step * 2.6);
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push_back(i == 0 ? 0 : i * step);
  return ticks;
}

double round_length(double longest) { return round_down(longest); }

std::string format_tick(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

int font_size_for(std::int64_t width) { return static_cast<int>(std::clamp<std::int64_t>(width / 72, 13, 28)); }

Picture hatching(std::int64_t width, std::int64_t height) {
  Picture picture(width, height, {228, 225, 231, 255});
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x)
      if ((x + y) % 9 < 2) picture(x, y) = {205, 200, 211, 255};
  return picture;
}

void style_legend(Legend& legend, const GroundStyle& style, double steepest_deg) {
  const std::string elevations = elevations_of(legend);
  if (style.colour == GroundColour::slope) {
    legend.title = "Slope in degrees" + elevations;
    legend.low = 0;
    legend.high = steepest_deg;
    legend.unit = "deg";
  } else if (style.colour == GroundColour::aspect) {
    legend.title = "Direction that the ground faces" + elevations;
    legend.low = 0;
    legend.high = 360;
    legend.marks = {{0, "N"}, {90, "E"}, {180, "S"}, {270, "W"}, {360, "N"}};
    legend.swatches.push_back({Picture(1, 1, flat_colour()), "flat"});
  }
  if (!(style.contour_interval_m > 0)) return;
  char text[64];
  std::snprintf(text, sizeof text, "contours every %.10g m", style.contour_interval_m);
  legend.note += (legend.note.empty() ? "" : "; ") + std::string(text);
}

void drape_legend(Legend& legend, const DrapePicture& drape, const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (!drape.opaque) {
    legend.note += (legend.note.empty() ? "" : "; ") + name + " over the ground";
    return;
  }
  legend.title = name + " over the ground" + elevations_of(legend);
  legend.low = legend.high = std::nan("");
  legend.marks.clear();
  std::erase_if(legend.swatches, [](const Legend::Swatch& swatch) { return swatch.label != "no data"; });
}

Legend value_legend(const DrapePicture& drape, const std::string& path) {
  Legend legend;
  legend.title = std::filesystem::path(path).filename().string();
  legend.low = drape.low;
  legend.high = drape.high;
  legend.unit.clear();
  return legend;
}

ColourRamp ramp_of(GroundColour colour, const ColourRamp& heights) {
  return colour == GroundColour::slope ? slope_ramp() : colour == GroundColour::aspect ? aspect_ramp() : heights;
}

Picture draw_legend(const Legend& legend, const ColourRamp& ramp, std::int64_t width) {
  const int font = font_size_for(width), small = std::max(11, font * 4 / 5);
  const std::int64_t margin = font, bar_high = font;
  const bool has_bar = !std::isnan(legend.low) && !std::isnan(legend.high), has_scale = legend.metres_per_pixel > 0;
  const std::int64_t title_y = margin + font, bar_y = title_y + font / 2;
  const std::int64_t labels_end = has_bar || has_scale ? bar_y + bar_high + font / 3 + font + font / 3 : title_y + font / 3;
  const bool last_line = !legend.swatches.empty() || !legend.note.empty();
  Picture picture(width, labels_end + (last_line ? margin / 2 + bar_high : 0) + margin, paper);

  draw_text(picture, margin, title_y, legend.title, font, ink);
  if (has_bar) {
    const std::int64_t bar_wide = has_scale ? width * 11 / 20 - margin : width - 4 * margin;
    draw_colour_bar(picture, legend, ramp, {margin, bar_y, bar_wide, bar_high}, font);
  }
  // On a narrow map it gives way to the title.
  if (has_scale && text_width(legend.title, font) + text_width(legend.scale_note, small) + 3 * margin <= width)
    draw_text(picture, width - margin, title_y, legend.scale_note, small, faint, Align::right);
  if (has_scale) draw_scale_bar(picture, legend.metres_per_pixel, width - margin, bar_y + bar_high / 3, width / 4, font);
  std::int64_t x = margin;
  const std::int64_t y = labels_end + margin / 2;
  for (const Legend::Swatch& swatch : legend.swatches) {
    const Window box{x, y, 2 * bar_high, bar_high};
    paste(picture, resize_picture(swatch.sample, box.width, box.height), x, y);
    frame(picture, box, faint);
    draw_text(picture, x + box.width + font / 2, y + font - font / 6, swatch.label, small, ink);
    x += box.width + font / 2 + text_width(swatch.label, small) + 2 * font;
  }
  // On a narrow map the note gives way to the swatches.
  if (x + text_width(legend.note, small) + margin <= width)
    draw_text(picture, width - margin, y + font - font / 6, legend.note, small, faint, Align::right);
  return picture;
}

}  // namespace arete
