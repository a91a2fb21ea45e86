#include "gis/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "core/terrain/hillshade.h"
#include "core/terrain/resample.h"
#include "core/terrain/slope.h"
#include "gis/colour_ramp.h"

namespace arete {
namespace {

constexpr std::int64_t sheet_width = 2048, largest_side = 64, most_pixels_per_sample = 8, separator = 2;
constexpr double shape = 1.5;        // columns to rows
constexpr double shown_slope = 0.6;  // root mean square of the exaggerated slopes, 31 degrees
constexpr double full_light = 0.85;  // shows a colour as it is; what hillshade gives a flat cell is 0.71
constexpr Colour paper = {255, 255, 255, 255}, ink = {45, 45, 48, 255};

struct Layout {
  std::int64_t columns = 1, rows = 1;
  std::int64_t tile = 1;  // pixels
};

Layout plan(std::int64_t atoms, std::int64_t samples) {
  Layout layout;
  layout.columns = std::max<std::int64_t>(1, std::llround(std::ceil(std::sqrt(shape * static_cast<double>(atoms)))));
  layout.columns = std::min(layout.columns, atoms);
  layout.rows = (atoms + layout.columns - 1) / layout.columns;
  const std::int64_t room = sheet_width / layout.columns - separator;
  layout.tile = samples * std::clamp<std::int64_t>(room / samples, 1, most_pixels_per_sample);
  return layout;
}

/// The samples of an atom as a square of terrain, averaged where there are more than can be shown.
Raster<float> atom_terrain(const Eigen::MatrixXf& atoms, Eigen::Index j, int side) {
  Raster<float> cells(side, side);
  std::copy_n(atoms.col(j).data(), cells.size().cells(), cells.data());
  const int block = static_cast<int>((side + largest_side - 1) / largest_side);
  return block > 1 ? area_average(std::as_const(cells).view(), block) : std::move(cells);
}

double slope_rms(RasterView<const float> cells) {
  double sum = 0;
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) {
      const Gradient g = horn_gradient(cells, x, y, {1, 1}).value_or(Gradient{});
      sum += g.east * g.east + g.north * g.north;
    }
  return std::sqrt(sum / static_cast<double>(cells.size().cells()));
}

Picture draw_atom(const Raster<float>& cells, const ColourRamp& ramp) {
  const auto view = cells.view();
  const double steepness = slope_rms(view);
  HillshadeOptions options;
  options.exaggeration = steepness > 0 ? shown_slope / steepness : 1;
  Raster<float> light(view.width, view.height);
  hillshade(view, {0, 0, view.width, view.height}, {1, 1}, options, light.view(), 1);
  const auto [low, high] = std::minmax_element(view.data, view.data + view.size().cells());
  const double base = static_cast<double>(*low), range = static_cast<double>(*high) - base;
  Picture picture(view.width, view.height);
  for (std::int64_t y = 0; y < view.height; ++y)
    for (std::int64_t x = 0; x < view.width; ++x) {
      Colour colour = ramp.at(range > 0 ? (static_cast<double>(view(x, y)) - base) / range : 0.5);
      const double brightness = static_cast<double>(light(x, y)) / full_light;
      for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<std::uint8_t>(std::clamp(std::lround(colour[c] * brightness), 0l, 255l));
      picture(x, y) = colour;
    }
  return picture;
}

}  // namespace

Picture draw_contact_sheet(const Dictionary& dictionary, const std::string& caption) {
  const bool has_high = dictionary.high.size() > 0;
  const Eigen::MatrixXf& atoms = has_high ? dictionary.high : dictionary.low;
  const int side = dictionary.patch_cells * (has_high ? dictionary.factor : 1);
  const std::int64_t count = std::min(dictionary.atoms(), most_sheet_atoms);
  const ColourRamp ramp = named_ramp("land");
  const Layout layout = plan(count, atom_terrain(atoms, 0, side).width());

  const std::int64_t step = layout.tile + separator, width = layout.columns * step + separator;
  const std::int64_t atoms_end = layout.rows * step + separator;
  // As large as fits on the sheet, and legible.
  int font = 16;
  while (font > 9 && text_width(caption, font) + 2 * separator > width) --font;
  const bool has_caption = !caption.empty() && !find_font().empty();
  Picture sheet(width, atoms_end + (has_caption ? 2 * font : 0), paper);
  for (std::int64_t j = 0; j < count; ++j) {
    const Picture atom = draw_atom(atom_terrain(atoms, j, side), ramp);
    paste(sheet, resize_picture(atom, layout.tile, layout.tile), separator + j % layout.columns * step,
          separator + j / layout.columns * step);
  }
  if (has_caption) draw_text(sheet, separator + 2, atoms_end + font + font / 4, caption, font, ink);
  return sheet;
}

}  // namespace arete
