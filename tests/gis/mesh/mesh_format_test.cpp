// What holds for every format, and for each of the plain ones.
#include "gis/mesh/mesh_format.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/support/random.h"
#include "gis/mesh/mesh_bounds.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

const std::vector<std::string> plain = {"PLY", "OBJ", "STL", "2DM", "DXF", "LandXML"};

const MeshFormat& format_named(const std::string& name) {
  const auto& all = mesh_formats();
  return *std::find_if(all.begin(), all.end(), [&](const MeshFormat& format) { return format.name == name; });
}

/// Whether the format numbers vertices as they were given.
bool keeps_numbers(const MeshFormat& format) { return format.name != "STL" && format.name != "DXF"; }

/// The largest distance between corners that belong together, per axis.
MeshVertex largest_shift(const std::vector<MeshVertex>& a, const std::vector<MeshVertex>& b) {
  MeshVertex shift;
  for (std::size_t i = 0; i < a.size(); ++i)
    shift = {std::max(shift.x, std::abs(a[i].x - b[i].x)), std::max(shift.y, std::abs(a[i].y - b[i].y)),
             std::max(shift.z, std::abs(a[i].z - b[i].z))};
  return shift;
}

struct Place {
  const char* crs;
  double x, y, z;
};

// UTM, web mercator near its corner, and geocentric (ECEF).
const Place places[] = {{"EPSG:32632+5773", 450123.456789, 5200000.123456789, 1234.5},
                        {"EPSG:3857", 19987654.321, -19912345.678, -12.25},
                        {"EPSG:4978", 4198765.4321, 174567.8901, 4781234.5678}};

TEST(MeshFormats, AreFoundByTheirExtensions) {
  EXPECT_EQ(mesh_format_of("a/b.PLY").name, "PLY");
  EXPECT_EQ(mesh_format_of("b.landxml").name, "LandXML");
  EXPECT_TRUE(is_mesh_path("x.2dm"));
  EXPECT_FALSE(is_mesh_path("x.tif"));
  EXPECT_FALSE(is_mesh_path("ply"));
  const Error error = error_of([] { mesh_format_of("x.mesh"); });
  EXPECT_EQ(error.kind(), ErrorKind::format);
  for (const MeshFormat& format : mesh_formats())
    for (const std::string& extension : format.extensions)
      EXPECT_NE(std::string(error.what()).find(extension), std::string::npos) << extension;
}

TEST(MeshFormats, AreCompleteAndTheirExtensionsAreTheirOwn) {
  std::set<std::string> extensions;
  for (const MeshFormat& format : mesh_formats()) {
    EXPECT_NE(format.write, nullptr) << format.name;
    EXPECT_NE(format.rounding, nullptr) << format.name;
    EXPECT_FALSE(format.description.empty()) << format.name;
    for (const std::string& extension : format.extensions) EXPECT_TRUE(extensions.insert(extension).second) << extension;
  }
}

// More than one block of 65,536 vertices and of triangles.
TEST(PlainMeshFormats, BringMeshesBackWithinTheirRounding) {
  for (const Place& place : places) {
    const MeshStore mesh = hills(270, place.x, place.y, place.z);
    const MeshBounds bounds = mesh_bounds(mesh);
    for (const std::string& name : plain) {
      SCOPED_TRACE(name + " at " + place.crs);
      const MeshFormat& format = format_named(name);
      TestFolder folder;
      const std::string path = folder / ("mesh" + format.extensions.front());
      format.write(mesh, frame_of(place.crs), path, {});
      const MeshFile back = read_mesh(path);
      EXPECT_EQ(back.format, name);
      EXPECT_EQ(back.mesh.triangles(), mesh.triangles());
      const MeshRounding rounding = format.rounding(bounds, {});
      const MeshVertex shift = largest_shift(corners_of(mesh), corners_of(back.mesh));
      EXPECT_LE(std::max(shift.x, shift.y), rounding.horizontal);
      EXPECT_LE(shift.z, rounding.vertical);
      if (name != "STL") {
        // Bit for bit, as a text of the doubles or as the doubles themselves.
        EXPECT_EQ(rounding.horizontal, 0);
        EXPECT_EQ(std::max({shift.x, shift.y, shift.z}), 0);
      } else {
        EXPECT_LT(std::max(rounding.horizontal, rounding.vertical), 1e-3);
      }
      if (keeps_numbers(format)) {
        EXPECT_EQ(triangles_of(back.mesh), triangles_of(mesh));
        EXPECT_EQ(back.mesh.vertices(), mesh.vertices());
      }
    }
  }
}

TEST(PlainMeshFormats, KeepTheReferenceSystem) {
  for (const Place& place : places)
    for (const std::string& name : plain) {
      SCOPED_TRACE(name + " at " + place.crs);
      const MeshFormat& format = format_named(name);
      TestFolder folder;
      const std::string path = folder / ("mesh" + format.extensions.front());
      const MeshFrame frame = frame_of(place.crs);
      format.write(hills(3, place.x, place.y), frame, path, {});
      const CrsSummary back = summarise_crs(read_mesh(path).frame.crs_wkt), given = summarise_crs(frame.crs_wkt);
      EXPECT_EQ(back.name, given.name);
      EXPECT_EQ(back.vertical_name, given.vertical_name);
      if (given.vertical_name.empty()) {
        EXPECT_EQ(back.authority, given.authority);
      }
    }
}

TEST(PlainMeshFormats, WithoutAReferenceSystemReadBackWithoutOne) {
  for (const std::string& name : plain) {
    const MeshFormat& format = format_named(name);
    TestFolder folder;
    const std::string path = folder / ("mesh" + format.extensions.front());
    format.write(hills(3, 0, 0), {}, path, {});
    // Coordinates are small: no offset either.
    EXPECT_EQ(folder.names(), std::vector<std::string>{"mesh" + format.extensions.front()}) << name;
    EXPECT_EQ(read_mesh(path).frame.crs_wkt, "") << name;
  }
}

TEST(PlainMeshFormats, KeepTheVerticalUnitOrTakeMetresOnly) {
  const MeshFrame feet = {crs_wkt("EPSG:32612"), "US survey foot", 1200.0 / 3937.0};
  for (const std::string& name : plain) {
    const MeshFormat& format = format_named(name);
    TestFolder folder;
    const std::string path = folder / ("mesh" + format.extensions.front());
    if (format.metric) continue;
    format.write(hills(3, 450000, 4000000), feet, path, {});
    const MeshFrame back = read_mesh(path).frame;
    EXPECT_EQ(back.vertical_unit, feet.vertical_unit) << name;
    EXPECT_EQ(back.metres_per_unit, feet.metres_per_unit) << name;
  }
}

TEST(MeshFormats, TheSameMeshGivesTheSameBytes) {
  MeshWriteOptions options;
  options.title = "Big Tujunga\nwithin 5 m <\"&\">";
  options.normals = true;
  for (const std::string& name : plain) {
    const MeshFormat& format = format_named(name);
    TestFolder one, two;
    const std::string file = "mesh" + format.extensions.front();
    for (const TestFolder* folder : {&one, &two})
      format.write(hills(20, 450000.5, 5200000.25), frame_of("EPSG:32632"), *folder / file, options);
    ASSERT_EQ(one.names(), two.names());
    for (const std::string& side : one.names()) EXPECT_EQ(get_file(one / side), get_file(two / side)) << side;
    EXPECT_EQ(triangles_of(read_mesh(one / file).mesh).size(), 19u * 19 * 2) << name;
  }
}

TEST(PlainMeshFormats, SayThatTheDiskIsFull) {
  for (const std::string& name : plain) {
    const Error error = error_of([&] { format_named(name).write(hills(3, 0, 0), {}, "/dev/full", {}); });
    EXPECT_EQ(error.kind(), ErrorKind::disk) << name;
    EXPECT_NE(std::string(error.what()).find("No space left on device"), std::string::npos) << error.what();
    EXPECT_EQ(error_of([&] { format_named(name).write(hills(3, 0, 0), {}, "/no/such/folder/mesh", {}); }).kind(), ErrorKind::disk)
        << name;
  }
}

TEST(PlainMeshFormats, SayThatAFileIsMissingOrAFolder) {
  TestFolder folder;
  for (const std::string& name : plain) {
    const std::string path = folder / ("mesh" + format_named(name).extensions.front());
    EXPECT_EQ(error_of([&] { read_mesh(path); }).kind(), ErrorKind::input) << name;
    std::filesystem::create_directory(path);
    EXPECT_EQ(error_of([&] { read_mesh(path); }).kind(), ErrorKind::input) << name;
  }
}

/// Reads bytes as a mesh: a sound mesh or an Error, nothing else. Whether there was an error.
bool is_refused(const std::string& path, const std::string& bytes) {
  put_file(path, bytes);
  try {
    EXPECT_TRUE(is_sound(read_mesh(path).mesh));
    return false;
  } catch (const Error& error) {
    EXPECT_TRUE(error.kind() == ErrorKind::input || error.kind() == ErrorKind::format) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return true;
  }
}

struct Damage {
  std::string name, path, bytes;
};

template <class Try>
void for_each_small_file(const Try& try_file) {
  for (const std::string& name : plain) {
    const MeshFormat& format = format_named(name);
    TestFolder folder;
    const std::string path = folder / ("mesh" + format.extensions.front());
    MeshWriteOptions options;
    options.title = "t";
    options.normals = true;
    format.write(hills(2, 450123.456789, 5200000.1), frame_of("EPSG:32632"), path, options);
    try_file(Damage{name, path, get_file(path)});
  }
}

TEST(PlainMeshFormats, EveryTruncationIsRefusedOrSound) {
  for_each_small_file([](const Damage& file) {
    std::size_t accepted = 0;
    for (std::size_t length = 0; length < file.bytes.size(); ++length)
      if (!is_refused(file.path, file.bytes.substr(0, length))) ++accepted;
    // OBJ and 2DM have no end and count nothing: all that is in them may be all there is. The others lack no more than a line
    // break.
    if (file.name != "OBJ" && file.name != "2DM") {
      EXPECT_LE(accepted, 1u) << file.name;
    }
  });
}

TEST(PlainMeshFormats, EveryChangedByteIsRefusedOrSound) {
  for_each_small_file([](const Damage& file) {
    for (std::size_t place = 0; place < file.bytes.size(); ++place)
      for (const int change : {0x01, 0x10, 0x80, 0xff}) {
        std::string bytes = file.bytes;
        bytes[place] = static_cast<char>(static_cast<unsigned char>(bytes[place]) ^ change);
        is_refused(file.path, bytes);
      }
  });
}

// Pieces of a file cut out, put in again elsewhere, or overwritten: 500 times per format.
TEST(PlainMeshFormats, DisorderedPiecesAreRefusedOrSound) {
  for_each_small_file([](const Damage& file) {
    for (std::uint64_t trial = 0; trial < 500; ++trial) {
      std::uint64_t draws = 0;
      const auto draw = [&](std::size_t below) { return static_cast<std::size_t>(hash_position(trial, draws++) % below); };
      std::string bytes = file.bytes;
      for (std::size_t change = draw(3); change < 3; ++change) {
        const std::string piece = bytes.substr(draw(bytes.size()), 1 + draw(12));
        const std::size_t place = draw(bytes.size());
        if (draw(3) > 0) bytes.erase(place, draw(12));
        if (draw(3) > 0 || bytes.empty()) bytes.insert(std::min(place, bytes.size()), piece);
      }
      is_refused(file.path, bytes);
    }
  });
}

TEST(PlainMeshFormats, ReadOfEachOtherAreRefused) {
  TestFolder folder;
  for (const std::string& from : plain) {
    const std::string path = folder / ("from" + format_named(from).extensions.front());
    format_named(from).write(hills(3, 0, 0), {}, path, {});
    for (const std::string& to : plain) {
      if (from == to) continue;
      EXPECT_TRUE(is_refused(folder / ("to" + format_named(to).extensions.front()), get_file(path))) << from << " as " << to;
    }
  }
}

}  // namespace
}  // namespace arete
