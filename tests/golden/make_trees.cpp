// Makes the golden trees again, from terrain made here: `make_trees FOLDER`, then `print_trees FOLDER/*.sct > FOLDER/expected.txt`.
// Needed only where the format changes; the files are not expected to stay the same when the encoder gets better.
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "core/support/error.h"
#include "core/support/file.h"
#include "core/support/random.h"
#include "core/synthesis/mountains.h"
#include "tests/core/tree/tree_sources.h"

namespace arete {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// A part of one range of mountains, turned into stored values by `store(metres, x, y)`.
template <class Store>
MemoryStored mountains(std::int64_t width, std::int64_t height, Store store) {
  MountainOptions options;
  options.threads = 1;
  static const Raster<float> range = synthesize_mountains({256, 256}, options);
  Raster<double> cells(width, height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) cells(x, y) = store(static_cast<double>(range(x, y)), x, y);
  return MemoryStored(std::move(cells));
}

const auto whole_metres = [](double metres, std::int64_t, std::int64_t) { return std::round(metres); };
const auto metres_as_they_are = [](double metres, std::int64_t, std::int64_t) { return metres; };

TreeHeader header_of(ValueType type) {
  TreeHeader header;
  header.type = type;
  return header;
}

CompressOptions target_of(TreeClaim kind, double value, int side) {
  CompressOptions options;
  options.target = {kind, value};
  options.node_side = side;
  options.threads = 1;
  return options;
}

class Folder {
 public:
  explicit Folder(std::string path) : path_(std::move(path)) {}
  void add(const std::string& name, const StoredSource& source, const TreeHeader& header, const CompressOptions& options) const {
    const MadeTree made = make_tree(source, header, options);
    write_file_atomically(path_ + "/" + name, made.file, true);
    std::printf("%s: %zu bytes\n", name.c_str(), made.file.size());
  }

 private:
  std::string path_;
};

void add_metres(const Folder& folder) {
  TreeHeader header = header_of(ValueType::int16);
  header.geo.transform = {600000, 30, 0, 5200000, 0, -30};
  header.geo.crs_wkt = "EPSG:32632";
  folder.add("mountains.sct", mountains(130, 96, whole_metres), header, target_of(TreeClaim::rmse, 4, 32));
  header.geo.nodata = -32768;
  const auto with_holes = [](double metres, std::int64_t x, std::int64_t y) {
    const bool hole = std::hypot(x - 60, y - 30) < 14 || x + y < 40 || metres < 560 || (x * 7 + y * 3) % 97 == 0;
    return hole ? nothing : std::round(metres);
  };
  folder.add("voids.sct", mountains(101, 70, with_holes), header, target_of(TreeClaim::rmse, 12, 32));
}

void add_floats(const Folder& folder) {
  TreeHeader header = header_of(ValueType::float32);
  header.geo.transform = {7.25, 0.0002, 0.00001, 46.5, 0.00001, -0.0002};
  header.geo.registration = Registration::point;
  header.geo.nodata = nothing;
  folder.add("rotated.sct", mountains(77, 61, metres_as_they_are), header, target_of(TreeClaim::rmse, 5, 64));
  folder.add("fine.sct", mountains(23, 19, metres_as_they_are), header_of(ValueType::float64), target_of(TreeClaim::rmse, 0.001, 32));
}

// A sea, and lakes on three heights.
void add_water(const Folder& folder) {
  const auto heights = [](std::int64_t x, std::int64_t y, double metres) {
    if (x + y < 60) return 0.0;
    if (std::hypot(x - 70, y - 40) < 13) return 612.0;
    if (std::hypot(x - 96, y - 70) < 11) return 655.0;
    return std::hypot(x - 40, y - 77) < 10 ? 655.5 : metres;
  };
  const auto whole = [&](double metres, std::int64_t x, std::int64_t y) { return std::floor(heights(x, y, metres)); };
  const auto with_holes = [&](double metres, std::int64_t x, std::int64_t y) { return x > 100 || (x * 7 + y * 3) % 97 == 0 ? nothing : heights(x, y, metres); };
  CompressOptions options = target_of(TreeClaim::rmse, 8, 32);
  options.flat = FlatWater::exact;
  folder.add("water.sct", mountains(110, 90, whole), header_of(ValueType::int16), options);
  folder.add("water_voids.sct", mountains(110, 90, with_holes), header_of(ValueType::float32), options);
}

void add_shapes(const Folder& folder) {
  folder.add("row.sct", mountains(150, 1, metres_as_they_are), header_of(ValueType::float32), target_of(TreeClaim::rmse, 2, 32));
  folder.add("column.sct", mountains(1, 90, whole_metres), header_of(ValueType::uint16), target_of(TreeClaim::rmse, 3, 32));
  folder.add("cell.sct", MemoryStored(Raster<double>(1, 1, 217)), header_of(ValueType::uint8), target_of(TreeClaim::rmse, 0.4, 32));
  folder.add("flat.sct", MemoryStored(Raster<double>(200, 160, 417)), header_of(ValueType::int16), target_of(TreeClaim::rmse, 0.4, 64));
}

void add_described(const Folder& folder) {
  TreeHeader header = header_of(ValueType::int32);
  header.scale = 0.01;
  header.offset = -50;
  header.geo.vertical_unit = "foot";
  header.geo.metres_per_unit = 0.3048;
  // Long enough to be packed.
  header.geo.crs_wkt =
      "COMPOUNDCRS[\"a local grid of the town's surveyors + heights over their datum\",ENGCRS[\"a local grid of the town's surveyors\","
      "EDATUM[\"a pillar in the market\"],CS[Cartesian,2],AXIS[\"easting (E)\",east,ORDER[1],LENGTHUNIT[\"foot\",0.3048]],"
      "AXIS[\"northing (N)\",north,ORDER[2],LENGTHUNIT[\"foot\",0.3048]]],VERTCRS[\"heights over their datum\",VDATUM[\"a step of the town hall\"],"
      "CS[vertical,1],AXIS[\"height (H)\",up,LENGTHUNIT[\"foot\",0.3048]]]]";
  header.band_name = "elevation";
  header.metadata = {{"AREA", "the mountains of the tests"}, {"EMPTY", ""}, {"HÖHE", "in hundredths of a foot"}};
  const auto hundredths = [](double metres, std::int64_t, std::int64_t) { return std::round((metres / 0.3048 + 50) * 100); };
  folder.add("described.sct", mountains(50, 40, hundredths), header, target_of(TreeClaim::psnr, 35, 32));
  folder.add("wide.sct", mountains(256, 203, whole_metres), header_of(ValueType::int16), target_of(TreeClaim::bytes, 1500, 256));
}

CompressOptions patches_of(int radius, int atoms, int sparsity) {
  CompressOptions options = target_of(TreeClaim::none, 0, 32);
  options.profile = TreeProfile::paper;
  options.patches.radius = radius;
  options.patches.atoms = atoms;
  options.patches.sparsity = sparsity;
  options.patches.quantiser_loss_db = 1;
  return options;
}

void add_patches(const Folder& folder) {
  const auto with_holes = [](double metres, std::int64_t x, std::int64_t y) {
    return std::hypot(x - 30, y - 20) < 8 || x > 60 || (x * 5 + y * 11) % 83 == 0 ? nothing : std::round(metres);
  };
  folder.add("patches.sct", mountains(40, 37, metres_as_they_are), header_of(ValueType::float32), patches_of(3, 6, 1));
  folder.add("patches_voids.sct", mountains(66, 43, with_holes), header_of(ValueType::int16), patches_of(6, 4, 2));
  folder.add("patches_many.sct", mountains(30, 22, metres_as_they_are), header_of(ValueType::float64), patches_of(2, 66, 4));
  folder.add("patches_root.sct", mountains(8, 5, whole_metres), header_of(ValueType::uint16), patches_of(2, 3, 3));
}

void add_predicted(const Folder& folder) {
  const auto with_holes = [](double metres, std::int64_t x, std::int64_t y) {
    return std::hypot(x - 44, y - 22) < 9 || x + 2 * y < 30 || (x * 3 + y * 17) % 89 == 0 ? nothing : std::round(metres);
  };
  const auto centimetres = [](double metres, std::int64_t, std::int64_t) { return static_cast<double>(static_cast<float>(std::round(metres * 100) / 100)); };
  folder.add("lossless.sct", mountains(61, 43, whole_metres), header_of(ValueType::int16), target_of(TreeClaim::lossless, 0, 32));
  folder.add("lossless_voids.sct", mountains(70, 39, with_holes), header_of(ValueType::int16), target_of(TreeClaim::lossless, 0, 32));
  folder.add("lossless_cm.sct", mountains(37, 29, centimetres), header_of(ValueType::float32), target_of(TreeClaim::lossless, 0, 32));
  folder.add("lossless_floats.sct", mountains(17, 12, metres_as_they_are), header_of(ValueType::float32), target_of(TreeClaim::lossless, 0, 32));
  const auto pi = [](double metres, std::int64_t x, std::int64_t y) { return x + y < 9 ? nothing : metres * 3.14159265358979; };
  folder.add("lossless_doubles.sct", mountains(19, 11, pi), header_of(ValueType::float64), target_of(TreeClaim::lossless, 0, 32));
  const auto nearly = [](double metres, std::int64_t x, std::int64_t y) {
    if (x + y < 7) return nothing;
    return (x * 7 + y * 5) % 31 == 0 || y == 14 ? metres : std::round(metres * 100) / 100;
  };
  const auto nearly_floats = [nearly](double metres, std::int64_t x, std::int64_t y) { return static_cast<double>(static_cast<float>(nearly(metres, x, y))); };
  folder.add("lossless_near.sct", mountains(41, 35, nearly_floats), header_of(ValueType::float32), target_of(TreeClaim::lossless, 0, 32));
  folder.add("lossless_near_doubles.sct", mountains(23, 19, nearly), header_of(ValueType::float64), target_of(TreeClaim::lossless, 0, 32));
  folder.add("lossless_root.sct", mountains(6, 8, whole_metres), header_of(ValueType::int32), target_of(TreeClaim::lossless, 0, 32));
  folder.add("bounded.sct", mountains(90, 75, metres_as_they_are), header_of(ValueType::float32), target_of(TreeClaim::max_error, 3, 64));
  folder.add("bounded_voids.sct", mountains(70, 39, with_holes), header_of(ValueType::int32), target_of(TreeClaim::max_error, 4, 32));
}

}  // namespace
}  // namespace arete

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("make_trees FOLDER\n", stderr);
    return 2;
  }
  const arete::Folder folder(arguments[1]);
  arete::add_metres(folder);
  arete::add_floats(folder);
  arete::add_water(folder);
  arete::add_shapes(folder);
  arete::add_described(folder);
  arete::add_patches(folder);
  arete::add_predicted(folder);
}
