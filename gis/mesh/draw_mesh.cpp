#include "gis/mesh/draw_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/support/error.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_plane.h"
#include "gis/mesh/raster_plane.h"
#include "gis/mesh/triangle_cells.h"

namespace arete {
namespace {

constexpr std::int64_t longest_map = 2048, heights_per_pixel = 2, lines_per_pixel = 4;
constexpr Colour ink = {28, 30, 44, 255};

/// The grid that heights are drawn on: heights_per_pixel cells for each pixel of the map, each way.
struct Drawing {
  GeoReference geo;
  Size map;
  double metres_per_pixel = 1;
  Size cells() const { return {map.width * heights_per_pixel, map.height * heights_per_pixel}; }
};

Drawing plan_drawing(const MeshSource& mesh, const MeshFrame& frame, std::int64_t width) {
  const MeshPlane plane = mesh_plane(mesh, frame);
  const double wide_m = plane.cell.x_m * static_cast<double>(plane.size.width), high_m = plane.cell.y_m * static_cast<double>(plane.size.height);
  const double metres = width > 0 ? wide_m / static_cast<double>(width) : std::max(wide_m, high_m) / longest_map;
  const auto pixels = [metres](double length) { return std::max<std::int64_t>(1, std::llround(length / metres)); };
  Drawing drawing;
  drawing.map = {pixels(wide_m), pixels(high_m)};
  drawing.metres_per_pixel = wide_m / static_cast<double>(drawing.map.width);
  const Size cells = drawing.cells();
  drawing.geo = plane.geo;
  (*drawing.geo.transform)[1] *= static_cast<double>(plane.size.width) / static_cast<double>(cells.width);
  (*drawing.geo.transform)[5] *= static_cast<double>(plane.size.height) / static_cast<double>(cells.height);
  return drawing;
}

/// Lines as dots, lines_per_pixel to a pixel each way: 16 bits for each pixel.
class Lines {
 public:
  explicit Lines(Size map) : map_(map), dots_(static_cast<std::size_t>(map.cells())) {}

  /// From (x0, y0) to (x1, y1) in dots, three dots wide.
  void draw(double x0, double y0, double x1, double y1) {
    const bool steep = std::fabs(y1 - y0) > std::fabs(x1 - x0);
    if (steep) std::swap(x0, y0), std::swap(x1, y1);
    if (x0 > x1) std::swap(x0, x1), std::swap(y0, y1);
    const double slope = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0;
    for (auto x = static_cast<std::int64_t>(std::floor(x0)); x <= static_cast<std::int64_t>(std::floor(x1)); ++x) {
      const double middle = std::clamp(static_cast<double>(x) + 0.5, x0, x1);
      const auto y = static_cast<std::int64_t>(std::floor(y0 + slope * (middle - x0)));
      for (std::int64_t beside = y - 1; beside <= y + 1; ++beside) steep ? dot(beside, x) : dot(x, beside);
    }
  }
  /// The share of a pixel that lines cover.
  double cover(std::int64_t pixel) const { return std::popcount(dots_[static_cast<std::size_t>(pixel)]) / 16.0; }

 private:
  void dot(std::int64_t x, std::int64_t y) {
    if (x < 0 || y < 0 || x >= map_.width * lines_per_pixel || y >= map_.height * lines_per_pixel) return;
    std::uint16_t& pixel = dots_[static_cast<std::size_t>(y / lines_per_pixel * map_.width + x / lines_per_pixel)];
    pixel = static_cast<std::uint16_t>(pixel | 1u << (y % lines_per_pixel * lines_per_pixel + x % lines_per_pixel));
  }
  Size map_;
  std::vector<std::uint16_t> dots_;
};

/// The highest triangle counts, as it does for who looks down.
void draw_heights(std::array<RasterPoint, 3> corners, Raster<float>& heights) {
  const Int128 area = twice_area(corners);
  if (area == 0) return;
  if (area < 0) std::swap(corners[1], corners[2]);
  for_cells_in_triangle(corners, {0, 0, heights.width(), heights.height()}, [&](const auto& span) {
    std::array<double, 3> share, step;
    for (std::size_t i = 0; i < 3; ++i) {
      share[i] = static_cast<double>(span.weights[i]) / static_cast<double>(span.area);
      step[i] = static_cast<double>(span.step[i]) / static_cast<double>(span.area);
    }
    for (std::int64_t column = span.first; column <= span.last; ++column) {
      const auto along = static_cast<double>(column - span.first);
      double z = 0;
      for (std::size_t i = 0; i < 3; ++i) z += (share[i] + along * step[i]) * corners[i].z;
      float& height = heights(column, span.row);
      if (is_void(height) || static_cast<float>(z) > height) height = static_cast<float>(z);
    }
  });
}

void draw_sides(const std::array<RasterPoint, 3>& corners, Lines& lines) {
  constexpr double scale = static_cast<double>(lines_per_pixel) / heights_per_pixel;
  const auto at = [](std::int64_t units) { return (static_cast<double>(units) / static_cast<double>(cell_units) + 0.5) * scale; };
  for (std::size_t k = 0; k < 3; ++k) {
    const RasterPoint &a = corners[k], &b = corners[(k + 1) % 3];
    lines.draw(at(a.column), at(a.row), at(b.column), at(b.row));
  }
}

/// The mean cover of the pixels within `reach` of each.
std::vector<float> mean_cover(const Lines& lines, Size map) {
  constexpr std::int64_t reach = 6;
  std::vector<double> sums(static_cast<std::size_t>((map.width + 1) * (map.height + 1)));  // of all pixels above and to the left
  const auto sum = [&](std::int64_t x, std::int64_t y) -> double& { return sums[static_cast<std::size_t>(y * (map.width + 1) + x)]; };
  for (std::int64_t y = 0; y < map.height; ++y)
    for (std::int64_t x = 0; x < map.width; ++x) sum(x + 1, y + 1) = lines.cover(y * map.width + x) + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
  std::vector<float> means(static_cast<std::size_t>(map.cells()));
  for (std::int64_t y = 0; y < map.height; ++y)
    for (std::int64_t x = 0; x < map.width; ++x) {
      const std::int64_t left = std::max<std::int64_t>(0, x - reach), right = std::min(map.width, x + reach + 1);
      const std::int64_t top = std::max<std::int64_t>(0, y - reach), bottom = std::min(map.height, y + reach + 1);
      const double inside = sum(right, bottom) - sum(left, bottom) - sum(right, top) + sum(left, top);
      means[static_cast<std::size_t>(y * map.width + x)] = static_cast<float>(inside / static_cast<double>((right - left) * (bottom - top)));
    }
  return means;
}

/// Lays the lines over a map whose left side is at column `left` of the picture.
void ink_lines(const Lines& lines, Size map, std::int64_t left, Picture& picture) {
  const std::vector<float> means = mean_cover(lines, map);
  for (std::int64_t y = 0; y < map.height; ++y)
    for (std::int64_t x = 0; x < map.width; ++x) {
      const std::int64_t pixel = y * map.width + x;
      const double open = 1 - static_cast<double>(means[static_cast<std::size_t>(pixel)]);
      const double opacity = lines.cover(pixel) * (0.05 + 0.65 * open * open);
      Colour& colour = picture(left + x, y);
      for (std::size_t c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>(std::lround(colour[c] + opacity * (ink[c] - colour[c])));
    }
}

}  // namespace

Relief draw_mesh(const MeshSource& mesh, const MeshFrame& frame, const MeshDrawOptions& options, Progress& progress) {
  const Drawing drawing = plan_drawing(mesh, frame, options.relief.width);
  RasterPoints points(mesh, RasterPlane(frame, drawing.geo), options.scratch, options.scratch.memory_bytes / 2, progress);
  Raster<float> heights(drawing.cells().width, drawing.cells().height, void_value);
  Lines lines(options.wireframe ? drawing.map : Size{});
  progress.begin("Drawing triangles", mesh.triangles());
  for_triangle_blocks(mesh, [&](std::int64_t first, std::span<const MeshTriangle> triangles) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::array<RasterPoint, 3> corners = corners_of(triangles[i], first + static_cast<std::int64_t>(i), points);
      draw_heights(corners, heights);
      if (options.wireframe) draw_sides(corners, lines);
    }
    progress.advance(static_cast<std::int64_t>(triangles.size()));
  });
  progress.end();

  ReliefOptions relief = options.relief;
  relief.width = drawing.map.width;
  const double cell_m = drawing.metres_per_pixel / heights_per_pixel;
  Relief drawn = draw_relief(ViewSource(heights.view()), {cell_m, cell_m}, relief, progress);
  if (options.wireframe) ink_lines(lines, drawing.map, (drawn.picture.width() - drawing.map.width) / 2, drawn.picture);
  return drawn;
}

}  // namespace arete
