#include "gis/mesh/dxf.h"

#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "gis/gdal_errors.h"
#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/meshes.h"

namespace arete {
namespace {

TEST(Dxf, IsReadFromItsSpecificationAlone) {
  TestFolder folder;
  const MeshStore mesh = hills(40, 450123.456789, 5200000.1);
  MeshWriteOptions options;
  options.title = "hills";
  write_dxf(mesh, {}, folder / "mesh.dxf", options);
  EXPECT_EQ(corners_of(read_by_python(folder / "mesh.dxf")), corners_of(mesh));
}

TEST(Dxf, IsReadByOgr) {
  TestFolder folder;
  const MeshStore mesh = hills(20, 450123.456789, 5200000.1);
  write_dxf(mesh, {}, folder / "mesh.dxf", {});
  const GdalErrors quiet;
  const GDALDatasetUniquePtr drawing(GDALDataset::Open((folder / "mesh.dxf").c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(drawing);
  std::vector<MeshVertex> corners;
  for (const auto& feature : *drawing->GetLayer(0)) {
    EXPECT_STREQ(feature->GetFieldAsString("Layer"), "TIN");
    const OGRLinearRing* ring = feature->GetGeometryRef()->toPolygon()->getExteriorRing();
    ASSERT_EQ(ring->getNumPoints(), 4);
    for (int i = 0; i < 3; ++i) corners.push_back({ring->getX(i), ring->getY(i), ring->getZ(i)});
  }
  EXPECT_EQ(corners, corners_of(mesh));
}

std::string drawing_of(const std::string& entities) { return "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n"; }

std::string face(const std::string& fourth) {
  return "0\n3DFACE\n8\nA\n10\n0\n20\n0\n30\n1\n11\n1\n21\n0\n31\n2\n12\n1\n22\n1\n32\n3\n13\n" + fourth;
}

TEST(Dxf, OfOtherProgramsIsRead) {
  TestFolder folder;
  const std::string others = "0\nLINE\n8\nB\n10\n0\n20\n0\n11\n1\n21\n1\n0\nTEXT\n8\nB\n10\n0\n20\n0\n40\n1\n1\nhello\n";
  put_file(folder / "mesh.dxf", drawing_of(others + face("1\n23\n1\n33\n3\n") + others));
  const MeshFile file = read_dxf(folder / "mesh.dxf", {});
  EXPECT_EQ(vertices_of(file.mesh), (std::vector<MeshVertex>{{0, 0, 1}, {1, 0, 2}, {1, 1, 3}}));
  EXPECT_EQ(triangles_of(file.mesh), (std::vector<MeshTriangle>{{0, 1, 2}}));
  put_file(folder / "mesh.dxf", drawing_of(face("0\n23\n1\n33\n3\n")));
  EXPECT_EQ(error_of([&] { read_dxf(folder / "mesh.dxf", {}); }).kind(), ErrorKind::input);
  put_file(folder / "mesh.dxf", drawing_of(others));
  EXPECT_EQ(error_of([&] { read_dxf(folder / "mesh.dxf", {}); }).kind(), ErrorKind::format);
}

}  // namespace
}  // namespace arete
