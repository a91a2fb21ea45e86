// UGRID 1.0, https://ugrid-conventions.github.io/ugrid-conventions/; CF 1.8, section 5.6 (crs_wkt). What QGIS reads of it: MDAL,
// mdal/frmts/mdal_ugrid.cpp and mdal_cf.cpp.
#include "gis/mesh/ugrid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <sstream>
#include <vector>

#include <netcdf.h>

#include "core/support/error.h"
#include "gis/crs.h"
#include "gis/mesh/mesh_blocks.h"
#include "gis/mesh/mesh_builder.h"
#include "gis/mesh/netcdf_header.h"
#include "gis/mesh/output_file.h"
#include "gis/vertical_unit.h"

namespace arete {
namespace {

/// Of one variable in a classic file with 64-bit offsets.
constexpr std::int64_t classic_bytes = (std::int64_t{1} << 32) - 4;
/// Deflate (NetCDF-4) makes 1032 bytes of one at best; a file that states more than that holds fewer.
constexpr std::uint64_t most_expansion = 1100;
constexpr std::size_t most_corners = 1000;

class Output {
 public:
  Output(const std::string& path, int mode) : path_(path) { check(nc_create(path.c_str(), mode, &id_)); }
  ~Output() {
    if (id_ >= 0) nc_abort(id_);
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  int dimension(const char* name, std::int64_t length) {
    int dimension = 0;
    check(nc_def_dim(id_, name, static_cast<std::size_t>(length), &dimension));
    return dimension;
  }
  int variable(const char* name, nc_type type, const std::vector<int>& dimensions) {
    int variable = 0;
    check(nc_def_var(id_, name, type, static_cast<int>(dimensions.size()), dimensions.data(), &variable));
    return variable;
  }
  void attribute(int variable, const char* name, const std::string& text) {
    check(nc_put_att_text(id_, variable, name, text.size(), text.c_str()));
  }
  void attribute(int variable, const char* name, int value) { check(nc_put_att_int(id_, variable, name, NC_INT, 1, &value)); }
  void attribute(int variable, const char* name, double value) { check(nc_put_att_double(id_, variable, name, NC_DOUBLE, 1, &value)); }
  void end_definitions() {
    int before = 0;
    check(nc_set_fill(id_, NC_NOFILL, &before));
    check(nc_enddef(id_));
  }
  void put(int variable, std::int64_t first, std::span<const double> values) {
    const std::size_t start = static_cast<std::size_t>(first), count = values.size();
    check(nc_put_vara_double(id_, variable, &start, &count, values.data()));
  }
  void put_faces(int variable, std::int64_t first, std::span<const int> corners) {
    const std::size_t start[] = {static_cast<std::size_t>(first), 0}, count[] = {corners.size() / 3, 3};
    check(nc_put_vara_int(id_, variable, start, count, corners.data()));
  }
  void close() { check(nc_close(std::exchange(id_, -1))); }

 private:
  void check(int status) const {
    if (status != NC_NOERR) throw Error(ErrorKind::disk, "cannot write '" + path_ + "': " + nc_strerror(status));
  }
  std::string path_;
  int id_ = -1;
};

/// The names and units of the horizontal axes in CF.
struct AxisNames {
  std::string standard_x, standard_y, long_x, long_y, unit_x, unit_y;
};

AxisNames axis_names(const CrsSummary& crs, bool known) {
  if (crs.geographic) return {"longitude", "latitude", "longitude", "latitude", "degrees_east", "degrees_north"};
  const std::string unit = crs.unit.empty() || crs.unit == "metre" ? "m" : crs.unit;
  if (!known) return {"", "", "x", "y", unit, unit};
  return {"projection_x_coordinate", "projection_y_coordinate", "x coordinate of projection", "y coordinate of projection", unit, unit};
}

void define_crs(Output& file, const char* name, const MeshFrame& frame, const CrsSummary& crs) {
  const int variable = file.variable(name, NC_INT, {});
  if (crs.geographic) file.attribute(variable, "grid_mapping_name", "latitude_longitude");
  if (!crs.name.empty()) file.attribute(variable, "name", crs.name);
  for (const char* key : {"crs_wkt", "spatial_ref", "wkt"}) file.attribute(variable, key, frame.crs_wkt);
  if (crs.authority.rfind("EPSG:", 0) != 0) return;
  file.attribute(variable, "EPSG_code", crs.authority);
  file.attribute(variable, "epsg", std::stoi(crs.authority.substr(5)));
}

/// An opened NetCDF file; -1 and nothing where something is not there.
class Input {
 public:
  explicit Input(const std::string& path) : path_(path) {
    std::error_code missing;
    if (!std::filesystem::is_regular_file(path, missing)) throw Error(ErrorKind::input, "cannot read '" + path + "': there is no such file");
    size_ = std::filesystem::file_size(path, missing);
    check_netcdf_header(path);
    const int status = nc_open(path.c_str(), NC_NOWRITE, &id_);
    if (status != NC_NOERR) throw Error(ErrorKind::input, "cannot read '" + path + "' as NetCDF: " + nc_strerror(status));
  }
  ~Input() { nc_close(id_); }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  [[noreturn]] void damaged(const std::string& what) const { throw Error(ErrorKind::input, "'" + path_ + "' is damaged: " + what + "; get it again"); }
  int variables() const {
    int count = 0;
    return nc_inq_nvars(id_, &count) == NC_NOERR ? count : 0;
  }
  int variable(const std::string& name) const {
    int variable = -1;
    return nc_inq_varid(id_, name.c_str(), &variable) == NC_NOERR ? variable : -1;
  }
  std::string name(int variable) const {
    char name[NC_MAX_NAME + 1] = "";
    return nc_inq_varname(id_, variable, name) == NC_NOERR ? name : "";
  }
  std::string text(int variable, const char* name) const {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    if (nc_inq_att(id_, variable, name, &type, &length) != NC_NOERR || length == 0 || length > size_) return "";
    if (type == NC_STRING) {
      std::vector<char*> words(length);
      if (nc_get_att_string(id_, variable, name, words.data()) != NC_NOERR) return "";
      const std::string first = words[0] == nullptr ? "" : words[0];
      nc_free_string(length, words.data());
      return first;
    }
    std::string text(length, '\0');
    if (type != NC_CHAR || nc_get_att_text(id_, variable, name, text.data()) != NC_NOERR) return "";
    return text.substr(0, text.find('\0'));
  }
  std::optional<double> number(int variable, const char* name) const {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    double value = 0;
    if (nc_inq_att(id_, variable, name, &type, &length) != NC_NOERR || length != 1 || type == NC_CHAR || type == NC_STRING) return {};
    return nc_get_att_double(id_, variable, name, &value) == NC_NOERR ? std::optional(value) : std::nullopt;
  }
  struct Dimension {
    std::string name;
    std::uint64_t length = 0;
  };
  std::vector<Dimension> dimensions(int variable) const {
    int count = 0;
    if (nc_inq_varndims(id_, variable, &count) != NC_NOERR || count < 0 || count > 2) return {};
    std::vector<int> ids(2);
    std::vector<Dimension> result;
    if (nc_inq_vardimid(id_, variable, ids.data()) != NC_NOERR) return {};
    for (int i = 0; i < count; ++i) {
      char name[NC_MAX_NAME + 1] = "";
      std::size_t length = 0;
      if (nc_inq_dim(id_, ids[static_cast<std::size_t>(i)], name, &length) != NC_NOERR) return {};
      result.push_back({name, length});
    }
    return result;
  }
  /// Throws where so many values of a byte or more cannot be in the file.
  void check_room(std::uint64_t values, const std::string& what) const {
    if (values / most_expansion > size_) damaged("it states " + std::to_string(values) + " " + what + " in " + std::to_string(size_) + " bytes");
  }
  void read(int variable, std::size_t first, std::span<double> to) const {
    const std::size_t count = to.size();
    check(nc_get_vara_double(id_, variable, &first, &count, to.data()), variable);
  }
  void read(int variable, const std::size_t (&start)[2], const std::size_t (&count)[2], std::span<double> to) const {
    check(nc_get_vara_double(id_, variable, start, count, to.data()), variable);
  }

 private:
  void check(int status, int variable) const {
    if (status != NC_NOERR) damaged("the variable '" + name(variable) + "' cannot be read: " + nc_strerror(status));
  }
  std::string path_;
  int id_ = -1;
  std::uint64_t size_ = 0;
};

int mesh_topology(const Input& file) {
  for (int i = 0; i < file.variables(); ++i)
    if (file.text(i, "cf_role") == "mesh_topology" && file.number(i, "topology_dimension") == 2) return i;
  return -1;
}

int elevations(const Input& file, const std::string& mesh) {
  for (int i = 0; i < file.variables(); ++i)
    if (file.text(i, "standard_name") == "altitude" && file.text(i, "mesh") == mesh && file.text(i, "location") == "node") return i;
  return file.variable(mesh + "_node_z");
}

MeshFrame read_ugrid_frame(const Input& file, int x, int z) {
  MeshFrame frame;
  int crs = -1;
  for (const std::string& name : {file.text(x, "grid_mapping"), std::string("projected_coordinate_system"), std::string("wgs84")})
    if (crs < 0 && !name.empty()) crs = file.variable(name);
  if (crs >= 0) {
    for (const char* key : {"crs_wkt", "spatial_ref", "wkt"})
      if (frame.crs_wkt.empty()) frame.crs_wkt = file.text(crs, key);
    const double epsg = file.number(crs, "epsg").value_or(0);
    if (frame.crs_wkt.empty() && epsg >= 1 && epsg < 1e6) frame.crs_wkt = expand_crs("EPSG:" + std::to_string(static_cast<int>(epsg)));
  }
  const std::string unit = z < 0 ? "" : file.text(z, "units");
  const VerticalUnit vertical = vertical_unit(unit, frame.crs_wkt);
  frame.vertical_unit = vertical.name;
  frame.metres_per_unit = vertical.metres;
  const double stated = z < 0 ? 0 : file.number(z, "metres_per_unit").value_or(0);
  if (std::isfinite(stated) && stated > 0) frame.metres_per_unit = stated;
  return frame;
}

void read_vertices(const Input& file, int x, int y, int z, std::uint64_t count, MeshBuilder& mesh) {
  std::vector<double> xs, ys, zs;
  for (std::uint64_t first = 0; first < count; first += mesh_block) {
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(mesh_block, count - first));
    for (auto* values : {&xs, &ys, &zs}) values->assign(n, 0);
    file.read(x, first, xs);
    file.read(y, first, ys);
    if (z >= 0) file.read(z, first, zs);
    for (std::size_t i = 0; i < n; ++i) {
      if (!std::isfinite(xs[i]) || !std::isfinite(ys[i]) || !std::isfinite(zs[i])) file.damaged("vertex " + std::to_string(first + i) + " is no number");
      mesh.add(MeshVertex{xs[i], ys[i], zs[i]});
    }
  }
}

void read_faces(const Input& file, int faces, const std::string& face_dimension, MeshBuilder& mesh) {
  const auto dimensions = file.dimensions(faces);
  if (dimensions.size() != 2) file.damaged("its faces are no table of two dimensions");
  // Corner x face is allowed too; then the topology says which dimension is that of faces.
  const bool turned = face_dimension == dimensions[1].name && face_dimension != dimensions[0].name;
  const std::uint64_t count = dimensions[turned ? 1 : 0].length, corners = dimensions[turned ? 0 : 1].length;
  if (corners < 3 || corners > most_corners) file.damaged("its faces have up to " + std::to_string(corners) + " corners");
  file.check_room(count * corners, "corners of faces");
  const double start = file.number(faces, "start_index").value_or(0), fill = file.number(faces, "_FillValue").value_or(-1e300);
  const std::uint64_t block = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(mesh_block) / corners);
  std::vector<double> table;
  for (std::uint64_t first = 0; first < count; first += block) {
    const std::uint64_t n = std::min(block, count - first);
    table.resize(static_cast<std::size_t>(n * corners));
    const std::size_t begin[] = {turned ? 0 : first, turned ? first : 0}, size[] = {turned ? corners : n, turned ? n : corners};
    file.read(faces, begin, size, table);
    for (std::uint64_t f = 0; f < n; ++f) {
      const auto corner = [&](std::uint64_t c) { return table[static_cast<std::size_t>(turned ? c * n + f : f * corners + c)]; };
      std::uint64_t used = 0;
      while (used < corners && corner(used) != fill) ++used;
      std::vector<std::int64_t> face;
      for (std::uint64_t c = 0; c < used; ++c) {
        const double index = corner(c) - start;
        if (!(index >= 0 && index < 9e15) || index != std::floor(index)) file.damaged("face " + std::to_string(first + f) + " names no vertex");
        face.push_back(static_cast<std::int64_t>(index));
      }
      for (std::size_t c = 2; c < face.size(); ++c) mesh.add(MeshTriangle{face[0], face[c - 1], face[c]});
    }
  }
}

}  // namespace

MeshRounding ugrid_rounding(const MeshBounds&, const MeshWriteOptions&) { return {}; }

void write_ugrid(const MeshSource& mesh, const MeshFrame& frame, const std::string& path, const MeshWriteOptions& options) {
  const std::int64_t vertices = mesh.vertices(), triangles = mesh.triangles();
  // A dimension of length 0 is the one without a limit.
  if (triangles == 0) throw Error(ErrorKind::format, "cannot write '" + path + "': UGRID holds no mesh without triangles");
  if (std::max(vertices, triangles) > std::numeric_limits<int>::max())
    throw Error(ErrorKind::format, "cannot write '" + path + "': UGRID for QGIS holds 2147483647 vertices and triangles, the mesh has " +
                                       std::to_string(vertices) + " and " + std::to_string(triangles) + "; cut it into parts");
  const bool large = vertices > classic_bytes / 8 || triangles > classic_bytes / 12;
  const CrsSummary crs = summarise_crs(frame.crs_wkt);
  const char* crs_name = crs.geographic ? "wgs84" : "projected_coordinate_system";

  Output file(path, NC_CLOBBER | (large ? NC_64BIT_DATA : NC_64BIT_OFFSET));
  const int node = file.dimension("mesh2d_nNodes", vertices), face = file.dimension("mesh2d_nFaces", triangles);
  const int corner = file.dimension("mesh2d_nMax_face_nodes", 3);
  file.attribute(NC_GLOBAL, "Conventions", "CF-1.8 UGRID-1.0");
  if (!options.title.empty()) file.attribute(NC_GLOBAL, "title", one_line(options.title));
  const int topology = file.variable("mesh2d", NC_INT, {});
  file.attribute(topology, "cf_role", "mesh_topology");
  file.attribute(topology, "long_name", "triangulated irregular network");
  file.attribute(topology, "topology_dimension", 2);
  file.attribute(topology, "node_coordinates", "mesh2d_node_x mesh2d_node_y");
  file.attribute(topology, "node_dimension", "mesh2d_nNodes");
  file.attribute(topology, "face_node_connectivity", "mesh2d_face_nodes");
  file.attribute(topology, "face_dimension", "mesh2d_nFaces");
  if (!frame.crs_wkt.empty()) define_crs(file, crs_name, frame, crs);

  const AxisNames names = axis_names(crs, !crs.name.empty());
  const int x = file.variable("mesh2d_node_x", NC_DOUBLE, {node}), y = file.variable("mesh2d_node_y", NC_DOUBLE, {node});
  const int z = file.variable("mesh2d_node_z", NC_DOUBLE, {node});
  const auto describe = [&](int variable, const std::string& standard, const std::string& long_name, const std::string& unit) {
    if (!standard.empty()) file.attribute(variable, "standard_name", standard);
    file.attribute(variable, "long_name", long_name);
    file.attribute(variable, "units", unit);
    file.attribute(variable, "mesh", "mesh2d");
    file.attribute(variable, "location", "node");
    if (!frame.crs_wkt.empty()) file.attribute(variable, "grid_mapping", crs_name);
  };
  describe(x, names.standard_x, names.long_x, names.unit_x);
  describe(y, names.standard_y, names.long_y, names.unit_y);
  describe(z, "altitude", "elevation", frame.vertical_unit);
  file.attribute(z, "positive", "up");
  file.attribute(z, "metres_per_unit", frame.metres_per_unit);
  file.attribute(z, "coordinates", "mesh2d_node_x mesh2d_node_y");
  const int faces = file.variable("mesh2d_face_nodes", NC_INT, {face, corner});
  file.attribute(faces, "cf_role", "face_node_connectivity");
  file.attribute(faces, "long_name", "corners of the triangles, counter-clockwise");
  file.attribute(faces, "start_index", 0);
  file.end_definitions();

  std::vector<double> values;
  const auto put = [&](int variable, double MeshVertex::*coordinate, std::int64_t first, std::span<const MeshVertex> block) {
    values.clear();
    for (const MeshVertex& v : block) values.push_back(v.*coordinate);
    file.put(variable, first, values);
  };
  for_vertex_blocks(mesh, [&](std::int64_t first, std::span<const MeshVertex> block) {
    put(x, &MeshVertex::x, first, block);
    put(y, &MeshVertex::y, first, block);
    put(z, &MeshVertex::z, first, block);
  });
  std::vector<int> corners;
  for_triangle_blocks(mesh, [&](std::int64_t first, std::span<const MeshTriangle> block) {
    corners.clear();
    for (const MeshTriangle& t : block)
      for (const std::int64_t index : t) corners.push_back(static_cast<int>(index));
    file.put_faces(faces, first, corners);
  });
  file.close();
}

MeshFile read_ugrid(const std::string& path, const Scratch& scratch) {
  const Input file(path);
  const int topology = mesh_topology(file);
  if (topology < 0)
    throw Error(ErrorKind::format, "cannot read '" + path + "': it is NetCDF without a mesh of faces (UGRID, a variable with cf_role mesh_topology)");
  const std::string mesh_name = file.name(topology);
  std::istringstream coordinates(file.text(topology, "node_coordinates"));
  std::string x_name, y_name;
  coordinates >> x_name >> y_name;
  const int x = file.variable(x_name), y = file.variable(y_name), z = elevations(file, mesh_name);
  const int faces = file.variable(file.text(topology, "face_node_connectivity"));
  if (x < 0 || y < 0 || faces < 0) file.damaged("the mesh '" + mesh_name + "' names coordinates or faces that are not there");
  const auto size = file.dimensions(x);
  for (const int variable : {x, y, z})
    if (variable >= 0 && (file.dimensions(variable).size() != 1 || file.dimensions(variable)[0].length != size[0].length))
      file.damaged("the coordinates of its vertices have different lengths");
  file.check_room(8 * size[0].length, "bytes of coordinates");

  MeshBuilder mesh(scratch);
  read_vertices(file, x, y, z, size[0].length, mesh);
  read_faces(file, faces, file.text(topology, "face_dimension"), mesh);
  MeshFile result;
  result.frame = read_ugrid_frame(file, x, z);
  result.format = "UGRID";
  result.mesh = mesh.finish(path);
  return result;
}

}  // namespace arete
