#include "gis/mesh/landxml.h"

#include <cpl_string.h>
#include <expat.h>

#include <cstring>
#include <exception>
#include <memory>
#include <optional>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/mesh/input_file.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/output_file.h"
#include "gis/mesh/side_files.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

constexpr std::size_t chunk_bytes = 65536;
constexpr std::size_t longest_content = 1024;

/// Text for an attribute in quotes.
std::string escaped(const std::string& text) {
  std::string line = one_line(text);
  if (!CPLIsUTF8(line.c_str(), -1)) {
    char* ascii = CPLForceToASCII(line.c_str(), -1, '?');
    line = ascii;
    CPLFree(ascii);
  }
  char* quoted = CPLEscapeString(line.c_str(), -1, CPLES_XML);
  const std::string result = quoted;
  CPLFree(quoted);
  return result;
}

void write_crs(OutputFile& file, const std::string& wkt) {
  if (wkt.empty()) return;
  const CrsSummary crs = summarise_crs(wkt);
  file.text(" <CoordinateSystem name=\"" + escaped(crs.name) + "\"");
  if (crs.authority.starts_with("EPSG:")) file.text(" epsgCode=\"" + crs.authority.substr(5) + "\"");
  if (!crs.vertical_name.empty()) file.text(" verticalDatum=\"" + escaped(crs.vertical_name) + "\"");
  file.text(" ogcWktCode=\"" + escaped(wkt1_of(wkt)) + "\"/>\n");
}

void write_points(OutputFile& file, const MeshSource& mesh) {
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> vertices) {
    for (const MeshVertex& v : vertices) {
      file.text("<P id=\"");
      file.integer(++first);
      file.text("\">");
      file.number(v.y);
      file.text(" ");
      file.number(v.x);
      file.text(" ");
      file.number(v.z);
      file.text("</P>\n");
    }
  });
}

void write_faces(OutputFile& file, const MeshSource& mesh) {
  for_triangle_blocks(mesh, [&](std::int64_t, std::span<const MeshTriangle> triangles) {
    for (const MeshTriangle& triangle : triangles) {
      file.text("<F>");
      for (std::size_t i = 0; i < 3; ++i) {
        if (i > 0) file.text(" ");
        file.integer(triangle[i] + 1);
      }
      file.text("</F>\n");
    }
  });
}

/// What is read, element by element. No exception may pass through expat: the first problem is kept, and reading stops.
class Surface {
 public:
  Surface(XML_Parser parser, const Scratch& scratch) : parser_(parser), mesh_(scratch) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, on_start, on_end);
    XML_SetCharacterDataHandler(parser, on_text);
  }

  const std::string& problem() const { return problem_; }
  /// Throws what was thrown where an element was read.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }
  bool landxml() const { return landxml_; }
  int surfaces() const { return surfaces_; }
  MeshFile finish(const std::string& path) { return {mesh_.finish(path), frame(), "LandXML"}; }

 private:
  enum class Place { elsewhere, points, faces };

  template <class Work>
  void guarded(const Work& work) {
    if (!problem_.empty()) return;
    try {
      work();
    } catch (...) {
      failure_ = std::current_exception();
      stop("reading failed");
    }
  }

  static void XMLCALL on_start(void* self, const char* name, const char** attributes) {
    auto* surface = static_cast<Surface*>(self);
    surface->guarded([&] { surface->start(local(name), attributes); });
  }
  static void XMLCALL on_end(void* self, const char* name) {
    auto* surface = static_cast<Surface*>(self);
    surface->guarded([&] { surface->end(local(name)); });
  }
  static void XMLCALL on_text(void* self, const char* text, int length) {
    auto* surface = static_cast<Surface*>(self);
    if (surface->collecting_ && surface->content_.size() < longest_content)
      surface->content_.append(text, static_cast<std::size_t>(length));
  }

  /// Without the prefix of a name space.
  static std::string_view local(const char* name) {
    const char* colon = std::strrchr(name, ':');
    return colon == nullptr ? name : colon + 1;
  }

  static std::string attribute(const char** attributes, std::string_view name) {
    for (; *attributes != nullptr; attributes += 2)
      if (attributes[0] == name) return attributes[1];
    return "";
  }

  void stop(const std::string& problem) {
    problem_ = problem;
    XML_StopParser(parser_, XML_FALSE);
  }

  void start(std::string_view name, const char** attributes) {
    if (depth_++ == 0) {
      landxml_ = name == "LandXML";
      if (!landxml_) return stop("its root is '" + one_line(std::string(name)) + "', not LandXML");
    }
    if (name == "Surface" && ++surfaces_ == 2)
      return stop("it holds more than one surface; expected one: put each in a file of its own");
    if (name == "Definition" && !attribute(attributes, "surfType").empty() && attribute(attributes, "surfType") != "TIN")
      return stop("its surface is a '" + one_line(attribute(attributes, "surfType")) + "'; expected TIN");
    if (name == "Pnts") place_ = Place::points;
    if (name == "Faces") place_ = Place::faces;
    if (name == "Metric" || name == "Imperial") {
      unit_ = attribute(attributes, "elevationUnit");
      if (unit_.empty()) unit_ = attribute(attributes, "linearUnit");
    }
    if (name == "CoordinateSystem") {
      wkt_ = attribute(attributes, "ogcWktCode");
      epsg_ = attribute(attributes, "epsgCode");
    }
    collecting_ = (place_ == Place::points && name == "P") || (place_ == Place::faces && name == "F");
    if (!collecting_) return;
    content_.clear();
    id_ = attribute(attributes, "id");
    visible_ = attribute(attributes, "i") != "1";
  }

  void end(std::string_view name) {
    --depth_;
    if (name == "Pnts" || name == "Faces") place_ = Place::elsewhere;
    if (!collecting_) return;
    collecting_ = false;
    if (place_ == Place::points)
      end_point();
    else if (visible_)
      end_face();
  }

  void end_point() {
    std::string_view words = content_;
    const auto number = parse_integer(id_);
    const auto y = parse_number(next_word(words)), x = parse_number(next_word(words)), z = parse_number(next_word(words));
    if (!number || !x || !y || !z || !next_word(words).empty())
      return stop("a point P is not a number and 'northing easting elevation'");
    if (!numbers_.add(*number)) return stop("the point " + std::to_string(*number) + " is given a second time");
    mesh_.add(MeshVertex{*x, *y, *z});
  }

  void end_face() {
    std::string_view words = content_;
    MeshTriangle triangle{};
    for (std::int64_t& corner : triangle) {
      const auto number = parse_integer(next_word(words));
      if (!number) return stop("a face F does not name three points");
      corner = numbers_.place_of(*number);
      if (corner < 0) return stop("a face F names the point " + std::to_string(*number) + ", which there is not");
    }
    if (!next_word(words).empty()) return stop("a face F names more than three points; expected 3: triangulate the mesh first");
    mesh_.add(triangle);
  }

  MeshFrame frame() const {
    MeshFrame frame;
    frame.crs_wkt = wkt2_of(wkt_);
    const std::string code = "EPSG:" + epsg_;
    if (frame.crs_wkt.empty() && !epsg_.empty() && expand_crs(code) != code) frame.crs_wkt = expand_crs(code);
    const VerticalUnit unit = vertical_unit(unit_, frame.crs_wkt);
    if (unit.known) {
      frame.vertical_unit = unit.metres == 1 ? "m" : unit.name;
      frame.metres_per_unit = unit.metres;
    }
    return frame;
  }

  XML_Parser parser_;
  MeshBuilder mesh_;
  PointNumbers numbers_;
  std::exception_ptr failure_;
  std::string problem_, content_, id_, unit_, wkt_, epsg_;
  Place place_ = Place::elsewhere;
  bool landxml_ = false, collecting_ = false, visible_ = true;
  int surfaces_ = 0, depth_ = 0;
};

}  // namespace

MeshRounding landxml_rounding(const MeshBounds&, const MeshWriteOptions&) { return {}; }

void write_landxml(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  if (frame.metres_per_unit != 1)
    throw Error(ErrorKind::format, "cannot write '" + path + "': LandXML is written in metres, the unit of z is '" +
                                       one_line(frame.vertical_unit) + "'");
  OutputFile file(path);
  file.text(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:schemaLocation=\"http://www.landxml.org/schema/LandXML-1.2 "
      "http://www.landxml.org/schema/LandXML-1.2/LandXML-1.2.xsd\" "
      "version=\"1.2\" date=\"1970-01-01\" time=\"00:00:00\">\n"
      " <Units><Metric areaUnit=\"squareMeter\" linearUnit=\"meter\" volumeUnit=\"cubicMeter\" temperatureUnit=\"celsius\" "
      "pressureUnit=\"milliBars\"/></Units>\n");
  write_crs(file, frame.crs_wkt);
  file.text(" <Application name=\"Arete\"/>\n <Surfaces>\n  <Surface name=\"" +
            escaped(options.title.empty() ? "TIN" : options.title) + "\">\n   <Definition surfType=\"TIN\">\n<Pnts>\n");
  write_points(file, mesh);
  file.text("</Pnts>\n<Faces>\n");
  write_faces(file, mesh);
  file.text("</Faces>\n   </Definition>\n  </Surface>\n </Surfaces>\n</LandXML>\n");
  file.close();
}

MeshFile read_landxml(const std::string& path, const Scratch& scratch) {
  InputFile file(path);
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr), &XML_ParserFree);
  if (!parser) throw Error(ErrorKind::memory, "cannot read '" + path + "': no memory for an XML parser");
  Surface surface(parser.get(), scratch);
  bool last = false;
  while (!last) {
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(file.left(), chunk_bytes));
    const auto bytes = file.take(count, "XML");
    last = file.left() == 0;
    if (XML_Parse(parser.get(), reinterpret_cast<const char*>(bytes.data()), static_cast<int>(count), last) == XML_STATUS_OK)
      continue;
    surface.rethrow();
    const std::string line = " at line " + std::to_string(XML_GetCurrentLineNumber(parser.get()));
    const bool is_landxml = surface.landxml();
    const std::string reason = surface.problem().empty() ? XML_ErrorString(XML_GetErrorCode(parser.get())) : surface.problem();
    throw Error(is_landxml ? ErrorKind::input : ErrorKind::format,
                "'" + path + (is_landxml ? "' is damaged" : "' is no LandXML file") + line + ": " + reason);
  }
  if (surface.surfaces() == 0) throw Error(ErrorKind::format, "'" + path + "' holds no surface");
  return surface.finish(path);
}

}  // namespace arete
