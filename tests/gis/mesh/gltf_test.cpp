#include "gis/mesh/gltf.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include "gis/crs.h"
#include "gis/mesh/mesh_bounds.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/hill_mesh.h"

namespace arete {
namespace {

/// The nearest place on the grid that the rounding states: its step is a power of two.
MeshVertex rounded(const MeshVertex& v, const MeshRounding& rounding) {
  const auto to = [](double c, double half) { return std::round(c / (2 * half)) * (2 * half); };
  return {to(v.x, rounding.horizontal), to(v.y, rounding.horizontal), to(v.z, rounding.vertical)};
}

/// On the grid whose axes may have different steps, vertices differ by no more than is stated.
void expect_near(const MeshSource& mesh, const MeshStore& found, const MeshRounding& rounding) {
  const auto before = sorted_corners(mesh), after = sorted_corners(found);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i)
    for (std::size_t k = 0; k < 9; ++k)
      ASSERT_LE(std::abs(before[i][k] - after[i][k]), k % 3 == 2 ? rounding.vertical : rounding.horizontal) << "triangle " << i << " coordinate " << k;
}

struct Place {
  const char* crs;
  double x, y;
};

// Far from the origin, 30 km wide: several nodes.
const Place places[] = {{"EPSG:32632+5773", 412345.678, 5212345.678}, {"EPSG:3857", 12958095.124, 4865499.469}, {"", -20037508, -15496570}};

TEST(Gltf, KeepsAMillimetreAnywhereAndMeetsWithoutCracks) {
  const TestFolder folder;
  for (const Place& place : places)
    for (const bool compress : {false, true})
      for (const char* name : {"mesh.glb", "mesh.gltf"}) {
        SCOPED_TRACE(std::string(place.crs) + " " + name + (compress ? " Draco" : ""));
        const MeshStore mesh = hill_mesh(60, 40, place.x, place.y, 500);
        MeshWriteOptions options;
        options.compress = compress;
        const MeshRounding rounding = gltf_rounding(mesh_bounds(mesh), options);
        EXPECT_EQ(rounding.horizontal, std::ldexp(1, compress ? -11 : -12));
        EXPECT_LE(rounding.vertical, rounding.horizontal);
        const MeshFrame frame{place.crs[0] == '\0' ? "" : crs_wkt(place.crs), "m", 1};
        write_gltf(mesh, frame, folder / name, options);
        const MeshFile file = read_gltf(folder / name);
        EXPECT_EQ(file.format, "glTF");
        EXPECT_EQ(file.frame.crs_wkt, frame.crs_wkt);
        // Equal vertices of different nodes became one again.
        EXPECT_EQ(file.mesh.vertices(), mesh.vertices());
        expect_near(mesh, file.mesh, rounding);
        EXPECT_EQ(sorted_corners(file.mesh), sorted_corners(mesh, [&](const MeshVertex& v) { return rounded(v, rounding); }));
      }
}

TEST(Gltf, KeepsAMillimetreInGeocentricCoordinates) {
  const TestFolder folder;
  // Round the Earth by a third of it: cells along all three axes.
  const MeshStore flat = hill_mesh(60, 40, 0, 0, 1);
  MeshStore mesh;
  for (const MeshVertex& v : vertices_of(flat)) {
    const double longitude = 0.1 + v.x * 0.0004, latitude = 0.8 + v.y * 0.0004, radius = 6371000 + v.z;
    mesh.append_vertices(std::vector<MeshVertex>{
        {radius * std::cos(latitude) * std::cos(longitude), radius * std::cos(latitude) * std::sin(longitude), radius * std::sin(latitude)}});
  }
  mesh.append_triangles(triangles_of(flat));
  for (const bool compress : {false, true}) {
    MeshWriteOptions options;
    options.compress = compress;
    const MeshRounding rounding = gltf_rounding(mesh_bounds(mesh), options);
    EXPECT_LE(std::max(rounding.horizontal, rounding.vertical), 0.0005);
    write_gltf(mesh, {crs_wkt("EPSG:4978"), "m", 1}, folder / "earth.glb", options);
    const MeshFile file = read_gltf(folder / "earth.glb");
    EXPECT_EQ(file.mesh.vertices(), mesh.vertices());
    expect_near(mesh, file.mesh, rounding);
  }
}

TEST(Gltf, HeightsOnTheGridComeBackExactly) {
  const TestFolder folder;
  MeshStore mesh = hill_mesh(12, 9, 500000, 5200000, 900);
  MeshStore stepped;
  for (MeshVertex v : vertices_of(mesh)) {
    v = {std::round(v.x * 1024) / 1024, std::round(v.y * 1024) / 1024, std::round(v.z * 1024) / 1024};
    stepped.append_vertices(std::vector<MeshVertex>{v});
  }
  stepped.append_triangles(triangles_of(mesh));
  for (const bool compress : {false, true}) {
    MeshWriteOptions options;
    options.compress = compress;
    write_gltf(stepped, {}, folder / "a.glb", options);
    EXPECT_EQ(sorted_corners(read_gltf(folder / "a.glb").mesh), sorted_corners(stepped));
  }
}

TEST(Gltf, ADecoderFromTheSpecificationReadsTheSame) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(60, 40, 12958095.124, 4865499.469, 500);
  write_gltf(mesh, {crs_wkt("EPSG:3857"), "m", 1}, folder / "mesh.glb", {});
  const std::string command = std::string(ARETE_TEST_PYTHON) + " -B " + ARETE_SOURCE_DIR + "/tests/gis/mesh/read_glb.py " + (folder / "mesh.glb") + " " +
                              (folder / "triangles") + " > " + (folder / "nodes");
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::vector<std::byte> bytes = read_file(folder / "triangles");
  ASSERT_EQ(bytes.size() % sizeof(Corners), 0u);
  std::vector<Corners> found(bytes.size() / sizeof(Corners));
  std::memcpy(found.data(), bytes.data(), bytes.size());
  // x = east, y = up, z = -north
  for (Corners& c : found)
    for (std::size_t i = 0; i < 9; i += 3) std::swap(c[i + 1], c[i + 2]), c[i + 1] = -c[i + 1];
  const MeshRounding rounding = gltf_rounding(mesh_bounds(mesh), {});
  EXPECT_EQ(sorted(found), sorted_corners(mesh, [&](const MeshVertex& v) { return rounded(v, rounding); }));
  int nodes = 0;
  std::ifstream(folder / "nodes") >> nodes;
  EXPECT_GE(nodes, 12);  // 30 x 20 km in cells of 8 km
}

tinygltf::Model load(const std::string& path) {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string errors, warnings;
  const bool binary = path.ends_with(".glb");
  EXPECT_TRUE(binary ? loader.LoadBinaryFromFile(&model, &errors, &warnings, path) : loader.LoadASCIIFromFile(&model, &errors, &warnings, path)) << errors;
  EXPECT_EQ(errors + warnings, "");
  return model;
}

std::vector<float> floats(const tinygltf::Model& model, int accessor) {
  const auto& a = model.accessors.at(static_cast<std::size_t>(accessor));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
  EXPECT_EQ(a.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
  std::vector<float> values(a.count * (a.type == TINYGLTF_TYPE_VEC3 ? 3 : 2));
  std::memcpy(values.data(), model.buffers.at(0).data.data() + view.byteOffset + a.byteOffset, values.size() * sizeof(float));
  return values;
}

void make_picture(const std::string& path) {
  const std::string source = path + ".tif";
  make_raster(source, 4, 4, GDT_Byte, std::vector<double>(16, 90));
  GDALDatasetUniquePtr from(GDALDataset::Open(source.c_str()));
  GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName("PNG")->CreateCopy(path.c_str(), from.get(), FALSE, nullptr, nullptr, nullptr));
}

TEST(Gltf, TinygltfFindsNormalsAndTheTexture) {
  const TestFolder folder;
  MeshStore mesh;  // a plane that rises 3 in 4 to the east
  mesh.append_vertices(std::vector<MeshVertex>{{1000, 2000, 0}, {1004, 2000, 3}, {1004, 2008, 3}, {1000, 2008, 0}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}, {0, 2, 3}});
  MeshWriteOptions options;
  options.title = "a plane";
  options.normals = true;
  options.texture = folder / "drape.png";
  options.texture_bounds = {{1000, 2000, 0}, {1008, 2008, 0}};
  make_picture(options.texture);
  for (const char* name : {"plane.glb", "plane.gltf"}) {
    write_gltf(mesh, {crs_wkt("EPSG:32632"), "m", 1}, folder / name, options);
    const tinygltf::Model model = load(folder / name);
    EXPECT_EQ(model.nodes.at(0).name, "a plane");
    ASSERT_EQ(model.meshes.size(), 1u);
    const auto& primitive = model.meshes[0].primitives.at(0);
    EXPECT_EQ(floats(model, primitive.attributes.at("TEXCOORD_0")), (std::vector<float>{0, 1, 0.5, 1, 0.5, 0, 0, 0}));
    const std::vector<float> normals = floats(model, primitive.attributes.at("NORMAL"));
    for (std::size_t i = 0; i < normals.size(); i += 3) {
      EXPECT_NEAR(normals[i], -0.6, 1e-6);
      EXPECT_NEAR(normals[i + 1], 0.8, 1e-6);
      EXPECT_NEAR(normals[i + 2], 0, 1e-6);
    }
    ASSERT_EQ(model.images.size(), 1u);
    EXPECT_EQ(model.images[0].width, 4);
    EXPECT_EQ(model.images[0].mimeType, "image/png");
    const auto& material = model.materials.at(static_cast<std::size_t>(primitive.material));
    EXPECT_EQ(material.pbrMetallicRoughness.baseColorTexture.index, 0);
  }
  options.compress = true;
  write_gltf(mesh, {}, folder / "draco.glb", options);
  EXPECT_EQ(sorted_corners(read_gltf(folder / "draco.glb").mesh), sorted_corners(mesh));
}

TEST(Gltf, RefusesATextureThatIsNoPicture) {
  const TestFolder folder;
  write_file_atomically(folder / "drape.png", std::as_bytes(std::span("no picture")), false);
  MeshWriteOptions options;
  options.texture = folder / "drape.png";
  try {
    write_gltf(hill_mesh(3, 3, 0, 0, 1), {}, folder / "a.glb", options);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
  }
}

// World coordinates are metres: the scale of a node says so, and reading gives the feet back.
TEST(Gltf, UnitsBecomeMetresAndComeBack) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(30, 20, 6000000.25, 2100000.5, 1500, 3000);
  const double us_foot = 1200.0 / 3937.0;
  const MeshFrame frame{crs_wkt("EPSG:2227"), "ft", 0.3048};  // NAD83 / California zone 3 (ftUS)
  write_gltf(mesh, frame, folder / "feet.gltf", {});
  const MeshFile file = read_gltf(folder / "feet.gltf");
  EXPECT_EQ(file.frame.vertical_unit, "ft");
  EXPECT_EQ(file.frame.metres_per_unit, 0.3048);
  const MeshRounding rounding = gltf_rounding(mesh_bounds(mesh), {});
  EXPECT_EQ(sorted_corners(file.mesh), sorted_corners(mesh, [&](const MeshVertex& v) { return rounded(v, rounding); }));
  const tinygltf::Model model = load(folder / "feet.gltf");
  ASSERT_EQ(model.nodes.at(0).scale.size(), 3u);
  EXPECT_NEAR(model.nodes[0].scale[0], us_foot, 1e-12);
  EXPECT_EQ(model.nodes[0].scale[1], 0.3048);
  EXPECT_NEAR(model.nodes[0].scale[2], us_foot, 1e-12);
}

// The sea: one square of 100 km in two triangles, a finer mesh beside it.
TEST(Gltf, HalvesEdgesThatNoNodeCanReach) {
  const TestFolder folder;
  MeshStore mesh;
  mesh.append_vertices(std::vector<MeshVertex>{{500000, 5200000, 0}, {600000, 5200000, 0}, {600000, 5300000, 0}, {500000, 5300000, 0}, {620000, 5250000, 1000}});
  mesh.append_triangles(std::vector<MeshTriangle>{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}});
  for (const bool compress : {false, true}) {
    MeshWriteOptions options;
    options.compress = compress;
    write_gltf(mesh, {}, folder / "sea.glb", options);
    const MeshFile file = read_gltf(folder / "sea.glb");
    // Area is kept, and the mesh stays whole: V - E + F = 1 for a disc, where each inner edge has two triangles.
    double area = 0;
    for (const Corners& c : sorted_corners(file.mesh)) {
      const double part = ((c[3] - c[0]) * (c[7] - c[1]) - (c[6] - c[0]) * (c[4] - c[1])) / 2;
      EXPECT_GT(part, 0);
      area += part;
    }
    EXPECT_NEAR(area, 1e10 + 1e9, 1);
    std::map<std::pair<std::int64_t, std::int64_t>, int> edges;
    for (const MeshTriangle& t : triangles_of(file.mesh))
      for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(t[i], t[(i + 1) % 3])];
    EXPECT_EQ(file.mesh.vertices() - std::ssize(edges) + file.mesh.triangles(), 1);
    EXPECT_GT(file.mesh.triangles(), 100);
  }
}

TEST(Gltf, IsTheSameForAnyMemory) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(60, 40, 412345.678, 5212345.678, 500);
  MeshWriteOptions options;
  for (const char* name : {"a.glb", "b.glb", "c.glb"}) {
    write_gltf(mesh, {}, folder / name, options);
    options.memory_bytes = name[0] == 'a' ? 1 << 16 : 256 << 20;
  }
  EXPECT_EQ(read_file(folder / "a.glb"), read_file(folder / "b.glb"));
  EXPECT_EQ(read_file(folder / "a.glb"), read_file(folder / "c.glb"));
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.glb", "b.glb", "c.glb"}));
}

TEST(Gltf, NodesHoldNoMoreThanIndicesOf16BitsName) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(400, 300, 500000, 5200000, 2);
  write_gltf(mesh, {}, folder / "dense.glb", {});
  const tinygltf::Model model = load(folder / "dense.glb");
  EXPECT_EQ(model.meshes.size(), 2u);
  for (const auto& m : model.meshes) EXPECT_LE(model.accessors.at(static_cast<std::size_t>(m.primitives.at(0).attributes.at("POSITION"))).count, 65535u);
  const MeshFile file = read_gltf(folder / "dense.glb");
  EXPECT_EQ(file.mesh.vertices(), mesh.vertices());
  EXPECT_EQ(file.mesh.triangles(), mesh.triangles());
}

void expect_refused(const std::function<void()>& action, ErrorKind kind, const std::string& word) {
  try {
    action();
    FAIL() << "expected a refusal that says " << word;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), kind) << e.what();
    EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

/// Counts without vertices: to be refused before anything is read.
class HugeMesh final : public MeshSource {
 public:
  std::int64_t vertices() const override { return 300'000'000; }
  std::int64_t triangles() const override { return 600'000'000; }
  void read_vertices(std::int64_t, std::span<MeshVertex>) const override { ADD_FAILURE() << "was read"; }
  void read_triangles(std::int64_t, std::span<MeshTriangle>) const override { ADD_FAILURE() << "was read"; }
};

TEST(Gltf, RefusesWhatItCannotHold) {
  const TestFolder folder;
  expect_refused([&] { write_gltf(HugeMesh(), {}, folder / "a.glb", {}); }, ErrorKind::format, "4 GiB");
  const MeshStore degrees = hill_mesh(3, 3, 7, 46, 0.001);
  expect_refused([&] { write_gltf(degrees, {crs_wkt("EPSG:4326"), "m", 1}, folder / "a.glb", {}); }, ErrorKind::format, "longitude");
  const MeshStore far = hill_mesh(3, 3, 1e12, 0, 1);
  expect_refused([&] { write_gltf(far, {}, folder / "a.glb", {}); }, ErrorKind::format, "2^27");
}

void write_text(const std::string& path, const std::string& text) { write_file_atomically(path, std::as_bytes(std::span(text)), true); }

TEST(Gltf, ReadsWhatOthersWrite) {
  const TestFolder folder;
  // A triangle without indices in a data URI, rotated by a quarter turn round y, scaled by 2, and mirrored by its parent's matrix.
  const std::string positions = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";  // (0,0,0) (1,0,0) (0,1,0)
  write_text(folder / "a.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,10,20,30,1]},)"
                                R"({"mesh":0,"scale":[2,2,2],"rotation":[0,0.7071067811865476,0,0.7071067811865476]}],)"
                                R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
                                R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                                    positions + R"("}]})");
  const MeshFile file = read_gltf(folder / "a.gltf");
  const auto vertices = vertices_of(file.mesh);
  ASSERT_EQ(vertices.size(), 3u);
  // The quarter turn takes (2, 0, 0) to (0, 0, -2), which is 2 to the north.
  const MeshVertex expected[] = {{10, -30, 20}, {10, -28, 20}, {10, -30, 22}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(vertices[i].x, expected[i].x, 1e-12);
    EXPECT_NEAR(vertices[i].y, expected[i].y, 1e-12);
    EXPECT_NEAR(vertices[i].z, expected[i].z, 1e-12);
  }
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 2, 1}}));  // mirrored: the other way round
}

TEST(Gltf, ReadsNothingFromElsewhere) {
  const TestFolder folder;
  for (const char* uri : {"/etc/passwd", "../a.bin", "sub/%2e%2e/%2e%2e/a.bin", "file:///etc/passwd", "http://example.org/a.bin"}) {
    write_text(folder / "a.gltf", std::string(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")") + uri + R"("}]})");
    expect_refused([&] { read_gltf(folder / "a.gltf"); }, ErrorKind::format, "beside it");
  }
}

TEST(Gltf, RefusesWhatIsNotWhatItSays) {
  const TestFolder folder;
  const auto refused = [&](const std::string& text, ErrorKind kind, const std::string& word) {
    write_text(folder / "a.gltf", text);
    expect_refused([&] { read_gltf(folder / "a.gltf"); }, kind, word);
  };
  refused("{}", ErrorKind::format, "no glTF");
  refused(R"({"asset":{"version":"1.0"}})", ErrorKind::format, "glTF 2");
  refused(R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_meshopt_compression"]})", ErrorKind::format, "EXT_meshopt_compression");
  refused(R"({"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[2]},{"children":[1]}],"scenes":[{"nodes":[0]}]})", ErrorKind::input, "parent");
  refused(std::string(100000, '[') , ErrorKind::input, "deep");
  refused(R"({"asset":{"version":"2.0"},"extras":)" + std::string(200000, '[') + std::string(200000, ']') + "}", ErrorKind::input, "deep");
  refused(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[7]}],"nodes":[{}]})", ErrorKind::input, "not there");
}

TEST(Gltf, SurvivesAnyDamage) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(5, 4, 412345.678, 5212345.678, 5000);
  MeshWriteOptions options;
  options.title = "hills";
  const auto read = [](const std::string& path) { return read_gltf(path).mesh; };
  for (const bool compress : {false, true}) {
    options.compress = compress;
    write_gltf(mesh, {crs_wkt("EPSG:32632"), "m", 1}, folder / "small.glb", options);
    EXPECT_GT(read_damaged(folder / "small.glb", folder / "bad.glb", 7, read), 100);
    write_gltf(mesh, {}, folder / "small.gltf", options);
    EXPECT_GT(read_damaged(folder / "small.gltf", folder / "bad.gltf", 3, read), 100);
    EXPECT_GT(read_damaged(folder / "small.bin", folder / "small.bin", 1, [&](const std::string&) { return read_gltf(folder / "small.gltf").mesh; }), 1);
  }
}

}  // namespace
}  // namespace arete
