#include "gis/mesh/side_files.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "core/support/error.h"
#include "core/support/file.h"
#include "gis/gdal_errors.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/output_file.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace fs = std::filesystem;
namespace {

constexpr double most_without_offset = 16384;
constexpr std::size_t longest_prj = 1 << 20;

/// "folder/name.obj" and "_offset.xyz" give "folder/name_offset.xyz".
std::string beside(const std::string& mesh_path, const char* ending) {
  const fs::path path(mesh_path);
  return (path.parent_path() / (path.stem().string() + ending)).string();
}

std::string export_wkt(const OGRSpatialReference& crs, const char* format) {
  const char* const options[] = {format, nullptr};
  char* text = nullptr;
  const OGRErr status = crs.exportToWkt(&text, options);
  const std::string wkt = status == OGRERR_NONE && text != nullptr ? text : "";
  CPLFree(text);
  return wkt;
}

double axis_offset(double low, double high) {
  if (std::max(std::abs(low), std::abs(high)) <= most_without_offset) return 0;
  return std::round(low + (high - low) / 2);
}

/// One unit in the last place of doubles of this size.
double ulp(double size) { return std::nextafter(size, std::numeric_limits<double>::infinity()) - size; }

}  // namespace

std::string wkt2_of(const std::string& wkt) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (wkt.empty() || crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return "";
  // The WKT of Esri has names of its own.
  const std::unique_ptr<OGRSpatialReference> known(crs.FindBestMatch(90, nullptr, nullptr));
  return export_wkt(known ? *known : crs, "FORMAT=WKT2_2019");
}

std::string wkt1_of(const std::string& wkt) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  const std::string simple = crs.importFromWkt(wkt.c_str()) == OGRERR_NONE ? export_wkt(crs, "FORMAT=WKT1_GDAL") : "";
  return simple.empty() ? wkt : simple;
}

void write_prj(const MeshFrame& frame, const std::string& mesh_path) {
  if (frame.crs_wkt.empty()) return;
  const GdalErrors quiet;
  OGRSpatialReference crs;
  std::string wkt = crs.importFromWkt(frame.crs_wkt.c_str()) == OGRERR_NONE ? export_wkt(crs, "FORMAT=WKT1_ESRI") : "";
  if (wkt.empty()) wkt = wkt1_of(frame.crs_wkt);
  OutputFile file(beside(mesh_path, ".prj"));
  file.text(wkt);
  file.text("\n");
  file.close();
}

MeshFrame read_prj(const std::string& mesh_path) {
  const std::string path = beside(mesh_path, ".prj");
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return {};
  const auto bytes = read_file_start(path, longest_prj);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  MeshFrame frame;
  frame.crs_wkt = wkt2_of(text);
  if (frame.crs_wkt.empty()) return {};
  const VerticalUnit unit = vertical_unit("", frame.crs_wkt);
  frame.vertical_unit = unit.name;
  frame.metres_per_unit = unit.metres;
  return frame;
}

std::string vertical_unit_text(const MeshFrame& frame) {
  return one_line(frame.vertical_unit) + " = " + number_text(frame.metres_per_unit) + " m";
}

void parse_vertical_unit(const std::string& text, MeshFrame& frame) {
  const std::size_t equals = text.rfind(" = ");
  if (equals == std::string::npos || equals == 0) return;
  std::string_view right = std::string_view(text).substr(equals + 3);
  const auto metres = parse_number(next_word(right));
  if (!metres || *metres <= 0 || next_word(right) != "m") return;
  frame.vertical_unit = text.substr(0, equals);
  frame.metres_per_unit = *metres;
}

MeshVertex mesh_offset(const MeshBounds& bounds) {
  return {axis_offset(bounds.low.x, bounds.high.x), axis_offset(bounds.low.y, bounds.high.y),
          axis_offset(bounds.low.z, bounds.high.z)};
}

void write_offset(const MeshVertex& offset, const std::string& mesh_path) {
  if (offset == MeshVertex{}) return;
  OutputFile file(beside(mesh_path, "_offset.xyz"));
  file.text(number_text(offset.x) + " " + number_text(offset.y) + " " + number_text(offset.z) + "\n");
  file.close();
}

MeshVertex read_offset(const std::string& mesh_path) {
  const std::string path = beside(mesh_path, "_offset.xyz");
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  InputFile file(path);
  std::string_view line = file.line().value_or("");
  const auto x = parse_number(next_word(line)), y = parse_number(next_word(line)), z = parse_number(next_word(line));
  if (!x || !y || !z)
    throw Error(ErrorKind::input,
                "'" + path + "' does not hold the offset of '" + mesh_path + "': expected one line with three numbers, x y z");
  return {*x, *y, *z};
}

// Let v be a coordinate, d = fl(v - o) and r = fl(o + d). All v of one sign and at least `least` in size are multiples of
// u = ulp(least), and so is o where it is whole and u <= 1; then v - o is a multiple of u, and where it is below 2^53 u a double:
// d = v - o and r = v. Otherwise |o + d - v| <= ulp(d) / 2, and r, the double next to o + d, is no farther from it than v, a
// double too: |r - v| <= ulp(d).
double offset_rounding(double low, double high, double offset) {
  if (offset == 0) return 0;
  const double largest = std::max(std::abs(low - offset), std::abs(high - offset));
  if ((low > 0 && high > 0) || (low < 0 && high < 0)) {
    const double u = ulp(std::min(std::abs(low), std::abs(high)));
    if (u <= 1 && largest <= u * 0x1p53) return 0;
  }
  return ulp(largest);
}

}  // namespace arete
