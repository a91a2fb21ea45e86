#include "gis/colour_ramp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/support/error.h"

namespace arete {
namespace {

using Lab = std::array<double, 3>;

double to_linear(std::uint8_t value) {
  const double v = value / 255.0;  // IEC 61966-2-1
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

std::uint8_t from_linear(double v) {
  v = std::clamp(v, 0.0, 1.0);
  const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

// Both matrices: B. Ottosson, https://bottosson.github.io/posts/oklab/
Lab to_oklab(Colour c) {
  const double r = to_linear(c[0]), g = to_linear(c[1]), b = to_linear(c[2]);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Colour from_oklab(const Lab& lab) {
  const double l = std::pow(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2], 3);
  const double m = std::pow(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2], 3);
  const double s = std::pow(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2], 3);
  return {from_linear(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          from_linear(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          from_linear(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 255};
}

Colour parse(const std::string& hex) {
  const unsigned long value = std::stoul(hex.substr(1), nullptr, 16);
  return {static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8 & 255),
          static_cast<std::uint8_t>(value & 255), 255};
}

// The largest chroma of which all hues of that lightness are within sRGB is about 0.12.
constexpr double aspect_lightness = 0.77, aspect_chroma = 0.095, north_hue_deg = 250;

double distance(const Lab& a, const Lab& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

struct NamedRamp {
  std::string name;
  std::vector<std::string> colours;
};

const std::vector<NamedRamp>& ramps() {
  static const std::vector<NamedRamp> known = {
      // Green lowland over straw and ochre to rock and snow; lightness grows all the way.
      {"land", {"#6f9e78", "#9cb886", "#c9cd98", "#dccfa2", "#e0cfb4", "#e9e0d4", "#fbfaf7"}},
      // The classic wall map: deep green, yellow, brown, grey, white.
      {"hypsometric", {"#3f8f5b", "#a9c77b", "#f2e6a2", "#d9a766", "#a87350", "#b9a79c", "#f8f6f3"}},
      // matplotlib's viridis (S. van der Walt, N. Smith; CC0), nine of its colours.
      {"viridis", {"#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"}},
      {"grey", {"#8c8c8c", "#f5f5f5"}},
  };
  return known;
}

}  // namespace

ColourRamp::ColourRamp(const std::vector<std::string>& colours) : table_(1024) {
  std::vector<Lab> stops;
  std::vector<double> along = {0};
  for (const std::string& colour : colours) {
    stops.push_back(to_oklab(parse(colour)));
    if (stops.size() > 1) along.push_back(along.back() + distance(stops[stops.size() - 2], stops.back()));
  }
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double at = along.back() * static_cast<double>(i) / static_cast<double>(table_.size() - 1);
    std::size_t part = 0;
    while (part + 2 < stops.size() && along[part + 1] < at) ++part;
    const double t = (at - along[part]) / (along[part + 1] - along[part]);
    Lab mixed;
    for (std::size_t c = 0; c < 3; ++c) mixed[c] = stops[part][c] + t * (stops[part + 1][c] - stops[part][c]);
    table_[i] = from_oklab(mixed);
  }
}

Colour ColourRamp::at(double position) const {
  const double last = static_cast<double>(table_.size() - 1);
  return table_[static_cast<std::size_t>(std::lround(std::clamp(position, 0.0, 1.0) * last))];
}

const std::vector<std::string>& ramp_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const NamedRamp& ramp : ramps()) all.push_back(ramp.name);
    return all;
  }();
  return names;
}

ColourRamp named_ramp(const std::string& name) {
  for (const NamedRamp& ramp : ramps())
    if (ramp.name == name) return ColourRamp(ramp.colours);
  std::string known;
  for (const std::string& other : ramp_names()) known += (known.empty() ? "" : ", ") + other;
  throw Error(ErrorKind::usage, "there is no colour ramp '" + name + "'; choose one of " + known);
}

ColourRamp difference_ramp() {
  return ColourRamp({"#0f3b73", "#2f79b5", "#8bbfdb", "#f5f4f2", "#ee9f80", "#c8433f", "#70101f"});
}

ColourRamp slope_ramp() { return ColourRamp({"#f8f6ee", "#f6e3a1", "#f0b45f", "#dd7148", "#b03a55", "#6f2561", "#321548"}); }

ColourRamp aspect_ramp() {
  ColourRamp ramp;
  for (int i = 0; i < 1024; ++i) {
    const double hue = north_hue_deg * M_PI / 180 - 2 * M_PI * i / 1023;
    ramp.table_.push_back(from_oklab({aspect_lightness, aspect_chroma * std::cos(hue), aspect_chroma * std::sin(hue)}));
  }
  return ramp;
}

Colour flat_colour() { return from_oklab({aspect_lightness, 0, 0}); }

double lightness(Colour colour) { return to_oklab(colour)[0]; }

}  // namespace arete
