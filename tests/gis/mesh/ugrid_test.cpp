#include "gis/mesh/ugrid.h"

#include <netcdf.h>

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "gis/crs.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/hill_mesh.h"

namespace arete {
namespace {

TEST(Ugrid, ComesBackBitForBit) {
  const TestFolder folder;
  const std::string path = folder / "mesh.nc";
  struct Place {
    const char* crs;
    double x, y, spacing;
    const char* unit;
    double metres;
  };
  for (const Place& place : {Place{"EPSG:32632+5773", 412345.678, 5212345.678, 500, "m", 1}, Place{"EPSG:4326", 7.1, 46.2, 0.003, "m", 1},
                             Place{"EPSG:4978", 4e6, 1e6, 10, "m", 1}, Place{"EPSG:2227", 6e6, 2e6, 100, "ft", 0.3048}, Place{"", 0, 0, 1, "braccio", 0.58}}) {
    SCOPED_TRACE(place.crs);
    const MeshStore mesh = hill_mesh(300, 250, place.x, place.y, place.spacing);  // more than one block
    const MeshFrame frame{place.crs[0] == '\0' ? "" : crs_wkt(place.crs), place.unit, place.metres};
    write_ugrid(mesh, frame, path, {});
    const MeshFile file = read_ugrid(path);
    EXPECT_EQ(file.format, "UGRID");
    EXPECT_EQ(vertices_of(file.mesh), vertices_of(mesh));
    EXPECT_EQ(triangles_of(file.mesh), triangles_of(mesh));
    EXPECT_EQ(file.frame.crs_wkt, frame.crs_wkt);
    EXPECT_EQ(file.frame.vertical_unit, frame.vertical_unit);
    EXPECT_EQ(file.frame.metres_per_unit, frame.metres_per_unit);
  }
}

TEST(Ugrid, RoundsNothing) {
  const MeshRounding rounding = ugrid_rounding({{0, 0, 0}, {1e7, 1e7, 9000}}, {});
  EXPECT_EQ(rounding.horizontal, 0);
  EXPECT_EQ(rounding.vertical, 0);
}

TEST(Ugrid, TheSameMeshGivesTheSameBytes) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(10, 10, 0, 0, 1);
  for (const char* name : {"a.nc", "b.nc"}) write_ugrid(mesh, {crs_wkt("EPSG:32632"), "m", 1}, folder / name, {});
  EXPECT_EQ(read_file(folder / "a.nc"), read_file(folder / "b.nc"));
}

// GDAL's own driver, array by array: the attributes that MDAL and CF look for.
TEST(Ugrid, GdalFindsTheConventions) {
  const TestFolder folder;
  const MeshStore mesh = hill_mesh(6, 5, 412345.678, 5212345.678, 30);
  MeshWriteOptions options;
  options.title = "hills";
  write_ugrid(mesh, {crs_wkt("EPSG:32632"), "m", 1}, folder / "mesh.nc", options);
  GDALAllRegister();
  const GDALDatasetUniquePtr dataset(GDALDataset::Open((folder / "mesh.nc").c_str(), GDAL_OF_MULTIDIM_RASTER));
  ASSERT_NE(dataset, nullptr);
  const auto root = dataset->GetRootGroup();
  const auto text = [&](const char* array, const char* name) { return std::string(root->OpenMDArray(array)->GetAttribute(name)->ReadAsString()); };
  EXPECT_EQ(std::string(root->GetAttribute("title")->ReadAsString()), "hills");
  EXPECT_EQ(text("mesh2d", "cf_role"), "mesh_topology");
  EXPECT_EQ(text("mesh2d", "node_coordinates"), "mesh2d_node_x mesh2d_node_y");
  EXPECT_EQ(text("mesh2d_node_x", "standard_name"), "projection_x_coordinate");
  EXPECT_EQ(text("mesh2d_node_z", "standard_name"), "altitude");
  EXPECT_EQ(text("mesh2d_node_z", "mesh"), "mesh2d");
  EXPECT_EQ(text("mesh2d_node_z", "location"), "node");
  EXPECT_EQ(text("projected_coordinate_system", "crs_wkt"), crs_wkt("EPSG:32632"));
  EXPECT_EQ(root->OpenMDArray("projected_coordinate_system")->GetAttribute("epsg")->ReadAsInt(), 32632);

  std::vector<double> z(30);
  const GUInt64 start[] = {0, 0};
  const size_t count[] = {30}, faces_count[] = {40, 3};
  ASSERT_TRUE(root->OpenMDArray("mesh2d_node_z")->Read(start, count, nullptr, nullptr, GDALExtendedDataType::Create(GDT_Float64), z.data()));
  std::vector<int> faces(120);
  ASSERT_TRUE(root->OpenMDArray("mesh2d_face_nodes")->Read(start, faces_count, nullptr, nullptr, GDALExtendedDataType::Create(GDT_Int32), faces.data()));
  const auto vertices = vertices_of(mesh);
  const auto triangles = triangles_of(mesh);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(z[i], vertices[i].z);
  for (std::size_t i = 0; i < 120; ++i) EXPECT_EQ(faces[i], triangles[i / 3][i % 3]);
}

// As others write: NetCDF-4, corner x face, counted from 1, a quadrangle beside a triangle, without elevations.
TEST(Ugrid, ReadsWhatOthersWrite) {
  const TestFolder folder;
  int id = 0, node = 0, face = 0, corner = 0, mesh = 0, x = 0, y = 0, faces = 0;
  ASSERT_EQ(nc_create((folder / "other.nc").c_str(), NC_NETCDF4, &id), NC_NOERR);
  nc_def_dim(id, "node", 5, &node);
  nc_def_dim(id, "face", 2, &face);
  nc_def_dim(id, "corner", 4, &corner);
  nc_def_var(id, "topology", NC_INT, 0, nullptr, &mesh);
  nc_def_var(id, "lon", NC_FLOAT, 1, &node, &x);
  nc_def_var(id, "lat", NC_FLOAT, 1, &node, &y);
  const int table[] = {corner, face};
  nc_def_var(id, "faces", NC_INT64, 2, table, &faces);
  const auto put = [&](int variable, const char* name, const std::string& text) { nc_put_att_text(id, variable, name, text.size(), text.c_str()); };
  put(mesh, "cf_role", "mesh_topology");
  put(mesh, "node_coordinates", "lon lat");
  put(mesh, "face_node_connectivity", "faces");
  put(mesh, "face_dimension", "face");
  const int two = 2, one = 1;
  nc_put_att_int(id, mesh, "topology_dimension", NC_INT, 1, &two);
  nc_put_att_int(id, faces, "start_index", NC_INT, 1, &one);
  const long long fill = -999;
  nc_put_att_longlong(id, faces, "_FillValue", NC_INT64, 1, &fill);
  nc_enddef(id);
  const float xs[] = {0, 1, 1, 0, 2}, ys[] = {0, 0, 1, 1, 0};
  const long long indices[] = {1, 2, 2, 5, 3, 3, 4, -999};
  nc_put_var_float(id, x, xs);
  nc_put_var_float(id, y, ys);
  nc_put_var_longlong(id, faces, indices);
  ASSERT_EQ(nc_close(id), NC_NOERR);
  const MeshFile file = read_ugrid(folder / "other.nc");
  EXPECT_EQ(vertices_of(file.mesh), (std::vector<MeshVertex>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}}));
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}}));
}

TEST(Ugrid, RefusesNetcdfWithoutAMesh) {
  const TestFolder folder;
  make_raster(folder / "dem.nc", 4, 4, GDT_Float32, std::vector<double>(16, 1), {}, "netCDF");
  try {
    read_ugrid(folder / "dem.nc");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::format);
  }
  EXPECT_THROW(read_ugrid(folder / "missing.nc"), Error);
  EXPECT_THROW(write_ugrid(MeshStore(), {}, folder / "empty.nc", {}), Error);
}

TEST(Ugrid, SurvivesAnyDamage) {
  const TestFolder folder;
  write_ugrid(hill_mesh(5, 4, 412345.678, 5212345.678, 30), {crs_wkt("EPSG:32632"), "m", 1}, folder / "small.nc", {});
  EXPECT_GT(read_damaged(folder / "small.nc", folder / "bad.nc", 1, [](const std::string& path) { return read_ugrid(path).mesh; }), 100);
}

}  // namespace
}  // namespace arete
