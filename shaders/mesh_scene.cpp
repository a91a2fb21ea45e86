#include "shaders/mesh_scene.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "core/support/error.h"
#include "core/terrain/fill_voids.h"
#include "core/terrain/sea.h"
#include "core/terrain/slope.h"
#include "shaders/mesh_border.h"

namespace arete {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::int64_t longest_overview = 1024, chunk_triangles = 2048;

Point3 cross(const Point3& a, const Point3& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
Point3 twice_area(const TriangleMesh& mesh, const Triangle& t) {
  return cross(subtract(mesh.vertices[t[1]], mesh.vertices[t[0]]), subtract(mesh.vertices[t[2]], mesh.vertices[t[0]]));
}

void extend(Box& box, const Point3& p) {
  for (std::size_t c = 0; c < 3; ++c) box.low[c] = std::min(box.low[c], p[c]), box.high[c] = std::max(box.high[c], p[c]);
}
constexpr Box empty_box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/// Throws where the mesh is damaged, leaves out what has no area, turns it over where it lies on its face.
void tidy(TriangleMesh& mesh) {
  const std::size_t vertices = mesh.vertices.size();
  for (std::size_t i = 0; i < vertices; ++i)
    if (!std::all_of(mesh.vertices[i].begin(), mesh.vertices[i].end(), [](double v) { return std::isfinite(v); }))
      throw Error(ErrorKind::input, "cannot draw the mesh: vertex " + std::to_string(i) + " is not finite");
  double from_above = 0, all = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangles[i];
    for (const std::uint32_t corner : t)
      if (corner >= vertices)
        throw Error(ErrorKind::input, "cannot draw the mesh: triangle " + std::to_string(i) + " names vertex " + std::to_string(corner) +
                                          ", but there are only " + std::to_string(vertices));
    const Point3 area = twice_area(mesh, t);
    if (dot(area, area) == 0) continue;
    from_above += area[2];
    all += std::abs(area[2]);
    mesh.triangles[kept++] = t;
  }
  mesh.triangles.resize(kept);
  if (from_above < -0.5 * all)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

Box ground_of(const TriangleMesh& mesh) {
  Box box = empty_box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t corner : t) extend(box, mesh.vertices[corner]);
  if (mesh.triangles.empty() || !(box.high[0] > box.low[0] && box.high[1] > box.low[1]))
    throw Error(ErrorKind::input, "cannot draw the mesh: it has no extent from west to east and from south to north");
  return box;
}

/// Interleaves 16 bits of each: along this curve what follows each other lies together (Morton 1966).
std::uint64_t morton(std::uint32_t x, std::uint32_t y) {
  const auto spread = [](std::uint64_t v) {
    v = (v | v << 8) & 0x00ff00ff;
    v = (v | v << 4) & 0x0f0f0f0f;
    v = (v | v << 2) & 0x33333333;
    return (v | v << 1) & 0x55555555;
  };
  return spread(x) | spread(y) << 1;
}

void sort_by_place(TriangleMesh& mesh, const Box& box) {
  std::vector<std::uint64_t> keys(mesh.triangles.size());
  const auto along = [&](const Triangle& t, std::size_t c) {
    const double middle = (mesh.vertices[t[0]][c] + mesh.vertices[t[1]][c] + mesh.vertices[t[2]][c]) / 3;
    return static_cast<std::uint32_t>(std::clamp((middle - box.low[c]) / (box.high[c] - box.low[c]) * 65535, 0.0, 65535.0));
  };
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = morton(along(mesh.triangles[i], 0), along(mesh.triangles[i], 1)) << 32 | i;
  std::sort(keys.begin(), keys.end());
  std::vector<Triangle> sorted;
  sorted.reserve(keys.size());
  for (const std::uint64_t key : keys) sorted.push_back(mesh.triangles[key & 0xffffffff]);
  mesh.triangles = std::move(sorted);
}

/// Heights from above at the centres of cells, NaN where there is no triangle.
Raster<float> heights_from_above(const TriangleMesh& mesh, const Box& box, Size size) {
  Raster<float> heights(size.width, size.height, void_value);
  const double cell_x = (box.high[0] - box.low[0]) / static_cast<double>(size.width), cell_y = (box.high[1] - box.low[1]) / static_cast<double>(size.height);
  for (const Triangle& t : mesh.triangles) {
    Point3 at[3];  // in cells, centres at whole numbers, rows downwards
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3& p = mesh.vertices[t[k]];
      at[k] = {(p[0] - box.low[0]) / cell_x - 0.5, (box.high[1] - p[1]) / cell_y - 0.5, p[2]};
    }
    const double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    if (area == 0) continue;
    const double along = ((at[1][2] - at[0][2]) * (at[2][1] - at[0][1]) - (at[2][2] - at[0][2]) * (at[1][1] - at[0][1])) / area;
    const double down = ((at[2][2] - at[0][2]) * (at[1][0] - at[0][0]) - (at[1][2] - at[0][2]) * (at[2][0] - at[0][0])) / area;
    const auto [top, bottom] = std::minmax({at[0][1], at[1][1], at[2][1]});
    for (auto y = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(top))); y < size.height && static_cast<double>(y) <= bottom; ++y) {
      double left = INFINITY, right = -INFINITY;
      for (std::size_t k = 0; k < 3; ++k) {
        const Point3 &a = at[k], &b = at[(k + 1) % 3];
        const double row = static_cast<double>(y);
        if (row < std::min(a[1], b[1]) || row > std::max(a[1], b[1])) continue;
        for (const double x : a[1] == b[1] ? std::array<double, 2>{a[0], b[0]} : std::array<double, 2>{a[0] + (row - a[1]) / (b[1] - a[1]) * (b[0] - a[0]), NAN}) {
          left = std::fmin(left, x);
          right = std::fmax(right, x);
        }
      }
      for (auto x = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(left))); x < size.width && static_cast<double>(x) <= right; ++x) {
        const auto z = static_cast<float>(at[0][2] + along * (static_cast<double>(x) - at[0][0]) + down * (static_cast<double>(y) - at[0][1]));
        float& height = heights(x, y);
        if (is_void(height) || z > height) height = z;
      }
    }
  }
  return heights;
}

/// Square cells, about as many as the triangles show.
void make_mesh_overview(const TriangleMesh& mesh, MeshScene& scene, const SceneOptions& options, Progress& progress) {
  const Box& box = scene.ground;
  const double wide = box.high[0] - box.low[0], high = box.high[1] - box.low[1];
  const auto shown = static_cast<std::int64_t>(5 * std::sqrt(static_cast<double>(mesh.triangles.size())));
  const std::int64_t longest = std::clamp(shown, std::int64_t{128}, longest_overview);
  const auto cells = [&](double length) {
    return std::clamp<std::int64_t>(std::llround(length / std::max(wide, high) * static_cast<double>(longest)), 2, longest);
  };
  const Size size{cells(wide), cells(high)};
  scene.block = {wide / static_cast<double>(size.width), high / static_cast<double>(size.height)};
  {
    const Raster<float> fine = heights_from_above(mesh, box, {2 * size.width, 2 * size.height});
    scene.overview = make_overview(ViewSource(fine.view()), 2, 2, options.threads, progress);
  }
  Raster<float>& heights = scene.overview.cells;
  if (std::all_of(heights.data(), heights.data() + heights.size().cells(), is_void))
    std::fill(heights.data(), heights.data() + heights.size().cells(), static_cast<float>(box.low[2]));
}

/// Before voids are filled.
SceneFacts survey(const MeshScene& scene, const SceneOptions& options) {
  const Raster<float>& heights = scene.overview.cells;
  const Raster<std::uint8_t> sea = find_sea(heights.view());
  SceneFacts facts;
  facts.low_m = scene.ground.low[2];
  facts.high_m = scene.ground.high[2];
  std::vector<float> land, slopes;
  for (std::int64_t y = 0; y < heights.height(); ++y)
    for (std::int64_t x = 0; x < heights.width(); ++x) {
      facts.has_water |= sea(x, y) != 0;
      if (is_void(heights(x, y)) || sea(x, y)) continue;
      land.push_back(heights(x, y));
      if (const auto slope = complete_gradient(heights.view(), x, y, scene.block)) slopes.push_back(static_cast<float>(std::hypot(slope->east, slope->north)));
    }
  settle_facts(facts, land, slopes, options);
  return facts;
}

/// Octahedral (Cigolla et al., "A Survey of Efficient Representations for Independent Unit Vectors", 2014), as unpackSnorm2x16 reads it.
std::uint32_t pack_normal(const std::array<float, 3>& n) {
  const float length = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  if (!(length > 0)) return 0;  // up
  float u = n[0] / length, v = n[1] / length;
  if (n[2] < 0) {
    const float folded_u = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f), folded_v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded_u, v = folded_v;
  }
  const auto bits = [](float x) { return static_cast<std::uint32_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * 32767)) & 0xffff; };
  return bits(u) | bits(v) << 16;
}

std::vector<std::array<float, 3>> sum_normals(const TriangleMesh& mesh) {
  std::vector<std::array<float, 3>> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Point3 area = twice_area(mesh, t);
    for (const std::uint32_t corner : t)
      for (std::size_t c = 0; c < 3; ++c) normals[corner][c] += static_cast<float>(area[c]);
  }
  return normals;
}

std::int32_t units(double metres, double unit_m) { return static_cast<std::int32_t>(std::llround(metres / unit_m)); }

void place_vertices(const TriangleMesh& mesh, MeshScene& scene) {
  const Point3 &low = scene.ground.low, &high = scene.ground.high;
  scene.unit_m = std::exp2(std::ceil(std::log2(std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}))) - 29);
  const std::vector<std::array<float, 3>> normals = sum_normals(mesh);
  scene.places.reserve(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Point3 p = mesh.vertices[i];
    // A vertex that no triangle names may lie anywhere.
    const auto at = [&](std::size_t c) { return units(std::clamp(p[c], low[c], high[c]) - low[c], scene.unit_m); };
    scene.places.push_back({at(0), at(1), at(2), pack_normal(normals[i])});
  }
}

/// A closed loop of the border.
class BorderLoop {
 public:
  BorderLoop(std::span<const BorderSide> sides, const std::vector<Point3>& vertices) : sides_(sides), vertices_(vertices), ends_{0} {
    for (const BorderSide& side : sides) {
      const Point3 along = subtract(vertices[side.to], vertices[side.from]);
      ends_.push_back(ends_.back() + std::hypot(along[0], along[1]));
    }
  }
  double length() const { return ends_.back(); }
  double begin_of(std::size_t side) const { return ends_[side]; }
  double end_of(std::size_t side) const { return ends_[side + 1]; }
  /// The mean direction outwards (to the right of the way) of all within `reach` of a place: across the chord.
  std::array<float, 3> outwards(double place, double reach) const {
    const std::array<double, 2> before = at(place - reach), after = at(place + reach);
    return {static_cast<float>(after[1] - before[1]), static_cast<float>(before[0] - after[0]), 0};
  }

 private:
  std::array<double, 2> at(double place) const {
    place -= std::floor(place / length()) * length();
    const auto side = std::min(static_cast<std::size_t>(std::upper_bound(ends_.begin() + 1, ends_.end(), place) - ends_.begin()) - 1, sides_.size() - 1);
    const Point3 &a = vertices_[sides_[side].from], &b = vertices_[sides_[side].to];
    const double share = std::clamp((place - ends_[side]) / (ends_[side + 1] - ends_[side]), 0.0, 1.0);
    return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
  }
  std::span<const BorderSide> sides_;
  const std::vector<Point3>& vertices_;
  std::vector<double> ends_;
};

/// Walls under the sides of the border, or under those of holes. Their light is that of the border within a hundredth of the mesh, so that the steps of cells
/// around voids are no stripes; sides that are longer are lit as they stand.
void add_walls(const std::vector<BorderSide>& border, const std::vector<Point3>& vertices, bool holes, MeshScene& scene) {
  const Point3 span = subtract(scene.ground.high, scene.ground.low);
  for (std::size_t first = 0, end; first < border.size(); first = end) {
    end = end_of_loop(border, first);
    if (border[first].hole != holes) continue;
    const BorderLoop loop(std::span<const BorderSide>(border).subspan(first, end - first), vertices);
    const double reach = std::min(0.01 * std::max(span[0], span[1]), loop.length() / 8);
    for (std::size_t i = first; i < end; ++i) {
      const double from = loop.begin_of(i - first), to = loop.end_of(i - first);
      if (!(to > from)) continue;
      const bool flat = to - from > reach;
      const auto add = [&](std::uint32_t above, double place, bool foot) {
        MeshPlace corner = scene.places[above];
        corner.normal = pack_normal(flat ? loop.outwards((from + to) / 2, 0.49 * (to - from)) : loop.outwards(place, reach));
        if (foot) corner.z = -1;
        scene.places.push_back(corner);
        return static_cast<std::uint32_t>(scene.places.size() - 1);
      };
      const std::uint32_t a = add(border[i].from, from, false), b = add(border[i].from, from, true);
      const std::uint32_t c = add(border[i].to, to, true), d = add(border[i].to, to, false);
      scene.triangles.push_back({a, b, c});
      scene.triangles.push_back({a, c, d});
    }
  }
}

/// Rows of cells under holes, which overlap a little: their corners do not meet those of the next row.
void add_floor(const Raster<std::uint8_t>& cells, MeshScene& scene) {
  const auto add = [&](double x, double y) {
    scene.places.push_back({units(x * scene.block.x_m, scene.unit_m), units((static_cast<double>(cells.height()) - y) * scene.block.y_m, scene.unit_m), -1, 0});
    return static_cast<std::uint32_t>(scene.places.size() - 1);
  };
  for (std::int64_t y = 0; y < cells.height(); ++y)
    for (std::int64_t x = 0, end; x < cells.width(); x = end) {
      for (end = x; end < cells.width() && cells(end, y);) ++end;
      if (end == x) {
        ++end;
        continue;
      }
      const auto left = static_cast<double>(x), right = static_cast<double>(end), top = static_cast<double>(y), bottom = top + 1.01;
      const std::uint32_t a = add(left, bottom), b = add(right, bottom), c = add(right, top), d = add(left, top);
      scene.triangles.push_back({a, b, c});
      scene.triangles.push_back({a, c, d});
    }
}

void make_chunks(MeshScene& scene) {
  const std::int64_t ends[] = {scene.first_wall, scene.first_side, scene.first_floor, static_cast<std::int64_t>(scene.triangles.size())};
  std::int64_t first = 0;
  for (const std::int64_t end : ends)
    while (first < end) {
      MeshChunk chunk{first, std::min(chunk_triangles, end - first), empty_box, first >= scene.first_wall};
      for (std::int64_t i = first; i < first + chunk.count; ++i)
        for (const std::uint32_t corner : scene.triangles[static_cast<std::size_t>(i)]) {
          const MeshPlace& p = scene.places[corner];
          const Point3& low = scene.ground.low;
          extend(chunk.box, {low[0] + p.x * scene.unit_m, low[1] + p.y * scene.unit_m, low[2] + std::max(0, p.z) * scene.unit_m});
        }
      scene.chunks.push_back(chunk);
      first += chunk.count;
    }
}

}  // namespace

std::int64_t mesh_bytes(std::int64_t vertices, std::int64_t triangles) {
  // A vertex: as it comes (24), its normal (12), as it is drawn (16). A triangle: twice (12) and its place (8).
  return 52 * vertices + 32 * triangles;
}

void require_mesh_memory(std::int64_t vertices, std::int64_t triangles, const SceneOptions& options) {
  constexpr std::int64_t most = std::int64_t{1} << 30;
  const std::int64_t bytes = vertices > most || triangles > most ? INT64_MAX : mesh_bytes(vertices, triangles);
  if (bytes <= options.memory_bytes) return;
  const auto megabytes = [](std::int64_t count) { return std::to_string((count + 999'999) / 1'000'000) + " MB"; };
  const std::string limit = bytes == INT64_MAX ? "at most 2^30 of each can be drawn; draw a coarser mesh"
                                               : "it takes " + megabytes(bytes) + ", and " + megabytes(options.memory_bytes) + " are given; give more memory, or a coarser mesh";
  throw Error(ErrorKind::memory, "cannot draw a mesh of " + std::to_string(triangles) + " triangles and " + std::to_string(vertices) + " vertices: " + limit);
}

std::unique_ptr<MeshScene> prepare_mesh(TriangleMesh mesh, const SceneOptions& options, Progress& progress) {
  require_mesh_memory(static_cast<std::int64_t>(mesh.vertices.size()), static_cast<std::int64_t>(mesh.triangles.size()), options);
  auto scene = std::make_unique<MeshScene>();
  tidy(mesh);
  scene->ground = ground_of(mesh);
  sort_by_place(mesh, scene->ground);
  make_mesh_overview(mesh, *scene, options, progress);
  scene->facts = survey(*scene, options);
  fill_voids(scene->overview.cells.view());

  place_vertices(mesh, *scene);
  std::vector<BorderSide> border = find_border(mesh);
  // Walls are few, but under a mesh of loose triangles.
  const auto sides = static_cast<std::int64_t>(border.size());
  require_mesh_memory(static_cast<std::int64_t>(mesh.vertices.size()) + 4 * sides, static_cast<std::int64_t>(mesh.triangles.size()) + 2 * sides, options);
  const Raster<std::uint8_t> under_holes =
      cells_of_holes(mesh, {scene->overview.cells.size(), scene->ground.low[0], scene->ground.high[1], scene->block}, border);
  scene->facts.has_voids = std::any_of(border.begin(), border.end(), [](const BorderSide& side) { return side.hole; });
  scene->triangles = std::move(mesh.triangles);
  const auto count = [&] { return static_cast<std::int64_t>(scene->triangles.size()); };
  scene->first_wall = count();
  if (options.walls) add_walls(border, mesh.vertices, false, *scene);
  scene->first_side = count();
  if (options.walls) add_walls(border, mesh.vertices, true, *scene);
  scene->first_floor = count();
  if (options.walls) add_floor(under_holes, *scene);
  make_chunks(*scene);
  light_mesh(*scene, scene->facts.exaggeration, options.sun_azimuth_deg, options.sun_elevation_deg, options);
  return scene;
}

void light_mesh(MeshScene& scene, double exaggeration, double sun_azimuth_deg, double sun_elevation_deg, const SceneOptions& options) {
  const bool same_heights = scene.facts.exaggeration == exaggeration && scene.light.sky.size().cells() > 0;
  scene.facts.exaggeration = exaggeration;
  const Point3 &from = scene.ground.low, &to = scene.ground.high;
  scene.base = foot_of_walls(from[2] * exaggeration, to[2] * exaggeration, std::max(to[0] - from[0], to[1] - from[1]));
  light_overview(scene.light, scene.overview.cells.view(), scene.block, exaggeration, sun_azimuth_deg, sun_elevation_deg, !same_heights, options.threads);
}

}  // namespace arete
