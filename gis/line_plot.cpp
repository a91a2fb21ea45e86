// A plot is laid out once, as marks, and the marks are drawn as pixels or written as SVG.
#include "gis/line_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "gis/legend.h"

namespace arete {
namespace {

constexpr double page_width = 960, page_height = 560;
constexpr double left = 72, right = page_width - 250, top = 64, bottom = page_height - 64;
constexpr int font = 14, title_font = 17;
constexpr Colour ink = {45, 45, 48, 255}, grid = {224, 224, 228, 255}, rim = {110, 110, 115, 255};

struct Point {
  double x = 0, y = 0;
};

struct Line {
  Point from, to;
  double width = 1;
  Colour colour;
};
struct Dot {
  Point at;
  double radius = 3;
  Colour colour;
};
struct Word {
  Point at;  ///< of the baseline
  std::string text;
  int size = font;
  Align align = Align::left;
};

/// What is on the page, in units of a pixel at scale 1.
struct Marks {
  std::vector<Line> lines;
  std::vector<Dot> dots;
  std::vector<Word> words;
};

/// From values to the page.
struct Axis {
  bool logarithmic = false;
  double low = 0, high = 1;  ///< values at its ends, low < high
  double start = 0, end = 1; ///< on the page
  bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  double place(double value) const {
    const auto along = [&](double v) { return logarithmic ? std::log(v) : v; };
    return start + (along(value) - along(low)) / (along(high) - along(low)) * (end - start);
  }
};

/// Round ticks; on a logarithmic axis 1, 2 and 5 times powers of ten, or powers alone where those would be too many.
std::vector<double> ticks_of(const Axis& axis, int wanted) {
  if (!axis.logarithmic) return round_ticks(axis.low, axis.high, wanted);
  const bool powers_only = std::log10(axis.high / axis.low) > 3;
  std::vector<double> ticks;
  for (int power = static_cast<int>(std::floor(std::log10(axis.low))); std::pow(10, power) <= axis.high; ++power)
    for (const int digit : {1, 2, 5}) {
      const double tick = digit * std::pow(10, power);
      if ((digit == 1 || !powers_only) && tick >= axis.low * (1 - 1e-9) && tick <= axis.high * (1 + 1e-9)) ticks.push_back(tick);
    }
  return ticks;
}

std::string tick_label(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// An axis that holds all values, with a little air.
Axis fit_axis(const LinePlot& plot, bool of_x) {
  Axis fitted;
  fitted.logarithmic = of_x ? plot.log_x : plot.log_y;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](double value) {
    if (fitted.shows(value)) low = std::min(low, value), high = std::max(high, value);
  };
  for (const LinePlot::Series& series : plot.series)
    for (const auto& [x, y] : series.points) take(of_x ? x : y);
  if (of_x)
    for (const double tick : plot.x_ticks) take(tick);
  if (!(low <= high)) low = 1, high = 10;
  if (fitted.logarithmic) {
    const double air = std::max(std::pow(high / low, 0.03), 1.02);
    low /= air, high *= air;
  } else {
    const double air = std::max(0.03 * (high - low), 1e-6 * std::max(1.0, std::abs(high)));
    low -= air, high += air;
  }
  if (!of_x && (plot.y_low != 0 || plot.y_high != 0)) low = plot.y_low, high = plot.y_high;
  fitted.low = low, fitted.high = high;
  fitted.start = of_x ? left : bottom;
  fitted.end = of_x ? right : top;
  return fitted;
}

/// The part of a line inside the frame (Liang & Barsky 1984); nothing where it is outside.
std::optional<Line> cut(Line line) {
  double first = 0, last = 1;
  const double dx = line.to.x - line.from.x, dy = line.to.y - line.from.y;
  const std::array<std::pair<double, double>, 4> sides = {{{-dx, line.from.x - left}, {dx, right - line.from.x}, {-dy, line.from.y - top}, {dy, bottom - line.from.y}}};
  for (const auto& [p, q] : sides) {
    if (p == 0 && q < 0) return std::nullopt;
    if (p < 0) first = std::max(first, q / p);
    if (p > 0) last = std::min(last, q / p);
  }
  if (first > last) return std::nullopt;
  const Point from = line.from;
  line.from = {from.x + first * dx, from.y + first * dy};
  line.to = {from.x + last * dx, from.y + last * dy};
  return line;
}

bool inside(Point point) { return point.x >= left - 0.5 && point.x <= right + 0.5 && point.y >= top - 0.5 && point.y <= bottom + 0.5; }

/// A line, or its dashes; `phase` runs on from line to line of a curve.
void add_line(Marks& marks, const Line& line, bool dashed, double& phase) {
  constexpr double dash = 6, period = 10;
  const double length = std::hypot(line.to.x - line.from.x, line.to.y - line.from.y);
  if (!dashed || length == 0) {
    marks.lines.push_back(line);
    return;
  }
  const auto at = [&](double t) {
    const double share = std::clamp(t / length, 0.0, 1.0);
    return Point{std::lerp(line.from.x, line.to.x, share), std::lerp(line.from.y, line.to.y, share)};
  };
  for (double t = -phase; t < length; t += period)
    if (t + dash > 0) marks.lines.push_back({at(t), at(t + dash), line.width, line.colour});
  phase = std::fmod(phase + length, period);
}

void add_axes(Marks& marks, const LinePlot& plot, const Axis& x, const Axis& y) {
  const std::vector<double> x_ticks = plot.x_ticks.empty() ? ticks_of(x, 8) : plot.x_ticks;
  for (const double tick : x_ticks) {
    const double at = x.place(tick);
    marks.lines.push_back({{at, top}, {at, bottom}, 1, grid});
    marks.words.push_back({{at, bottom + 20}, tick_label(tick), font, Align::centre});
  }
  const std::vector<double> y_ticks = ticks_of(y, 8);
  for (const double tick : y_ticks) {
    const double at = y.place(tick);
    marks.lines.push_back({{left, at}, {right, at}, 1, grid});
    marks.words.push_back({{left - 8, at + 5}, tick_label(tick), font, Align::right});
  }
  marks.lines.push_back({{left, top}, {left, bottom}, 1, rim});
  marks.lines.push_back({{left, bottom}, {right, bottom}, 1, rim});
  marks.words.push_back({{left - 56, 26}, plot.title, title_font, Align::left});
  marks.words.push_back({{left - 56, top - 12}, plot.y_title, font, Align::left});
  marks.words.push_back({{(left + right) / 2, bottom + 46}, plot.x_title, font, Align::centre});
}

void add_series(Marks& marks, const LinePlot::Series& series, const Axis& x, const Axis& y) {
  const double width = series.strong ? 3 : 1.8;
  std::optional<Point> last;
  double phase = 0;
  for (const auto& [value_x, value_y] : series.points) {
    if (!x.shows(value_x) || !y.shows(value_y)) continue;
    const Point point{x.place(value_x), y.place(value_y)};
    if (last)
      if (const auto line = cut({*last, point, width, series.colour})) add_line(marks, *line, series.dashed, phase);
    if (inside(point)) marks.dots.push_back({point, series.strong ? 4.0 : 3.0, series.colour});
    last = point;
  }
}

void add_legend(Marks& marks, const LinePlot& plot) {
  const double x = right + 18;
  double y = top + 10;
  for (const LinePlot::Series& series : plot.series) {
    if (series.name.empty()) continue;
    double phase = 0;
    add_line(marks, {{x, y}, {x + 26, y}, series.strong ? 3 : 1.8, series.colour}, series.dashed, phase);
    marks.dots.push_back({{x + 13, y}, series.strong ? 4.0 : 3.0, series.colour});
    marks.words.push_back({{x + 34, y + 5}, series.name, font, Align::left});
    y += 23;
  }
  if (!plot.note.empty()) marks.words.push_back({{x, y + 10}, plot.note, font - 2, Align::left});
}

Marks lay_out(const LinePlot& plot) {
  const Axis x = fit_axis(plot, true), y = fit_axis(plot, false);
  Marks marks;
  add_axes(marks, plot, x, y);
  for (const LinePlot::Series& series : plot.series) add_series(marks, series, x, y);
  add_legend(marks, plot);
  return marks;
}

/// Mixes the colour in where a shape covers a pixel; `distance` from the shape's spine, `radius` its half width.
template <typename F>
void paint(Picture& picture, Point low, Point high, double radius, Colour colour, const F& distance) {
  const auto from = [](double v) { return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(v))); };
  for (std::int64_t y = from(low.y - radius - 1); y < std::min(picture.height(), from(high.y + radius + 2)); ++y)
    for (std::int64_t x = from(low.x - radius - 1); x < std::min(picture.width(), from(high.x + radius + 2)); ++x) {
      const double cover = std::clamp(radius + 0.5 - distance(Point{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5}), 0.0, 1.0);
      Colour& pixel = picture(x, y);
      for (std::size_t i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(std::lround(std::lerp(double{1} * pixel[i], double{1} * colour[i], cover)));
    }
}

void paint_line(Picture& picture, Line line, double scale) {
  const Point a{line.from.x * scale, line.from.y * scale}, b{line.to.x * scale, line.to.y * scale};
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  paint(picture, {std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}, line.width * scale / 2, line.colour, [&](Point p) {
    const double along = square == 0 ? 0 : std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0);
    return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
  });
}

std::string hex(Colour colour) {
  char text[16];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

std::string escape_xml(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  return safe;
}

}  // namespace

Colour plot_colour(std::size_t index) {
  constexpr std::array<Colour, 7> colours = {{{0, 0, 0, 255}, {0, 114, 178, 255}, {86, 180, 233, 255}, {213, 94, 0, 255}, {0, 158, 115, 255},
                                              {204, 121, 167, 255}, {230, 159, 0, 255}}};
  return colours[index % colours.size()];
}

Picture draw_line_plot(const LinePlot& plot, int scale) {
  const Marks marks = lay_out(plot);
  Picture picture(static_cast<std::int64_t>(page_width) * scale, static_cast<std::int64_t>(page_height) * scale);
  for (const Line& line : marks.lines) paint_line(picture, line, scale);
  for (const Dot& dot : marks.dots) {
    const Point centre{dot.at.x * scale, dot.at.y * scale};
    paint(picture, centre, centre, dot.radius * scale, dot.colour, [&](Point p) { return std::hypot(p.x - centre.x, p.y - centre.y); });
  }
  for (const Word& word : marks.words)
    draw_text(picture, std::lround(word.at.x * scale), std::lround(word.at.y * scale), word.text, word.size * scale, ink, word.align);
  return picture;
}

std::string line_plot_svg(const LinePlot& plot) {
  const Marks marks = lay_out(plot);
  char text[256];
  std::snprintf(text, sizeof text, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\"", page_width, page_height,
                page_width, page_height);
  std::string svg = std::string(text) + " font-family=\"DejaVu Sans, Verdana, sans-serif\" role=\"img\">\n<title>" + escape_xml(plot.title) + "</title>\n";
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const Line& line : marks.lines) {
    std::snprintf(text, sizeof text, "<path d=\"M%.2f %.2fL%.2f %.2f\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linecap=\"round\"/>\n", line.from.x, line.from.y,
                  line.to.x, line.to.y, hex(line.colour).c_str(), line.width);
    svg += text;
  }
  for (const Dot& dot : marks.dots) {
    std::snprintf(text, sizeof text, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.1f\" fill=\"%s\"/>\n", dot.at.x, dot.at.y, dot.radius, hex(dot.colour).c_str());
    svg += text;
  }
  for (const Word& word : marks.words) {
    const char* anchor = word.align == Align::left ? "start" : word.align == Align::centre ? "middle" : "end";
    std::snprintf(text, sizeof text, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%d\" text-anchor=\"%s\" fill=\"%s\">", word.at.x, word.at.y, word.size, anchor, hex(ink).c_str());
    svg += text + escape_xml(word.text) + "</text>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace arete
