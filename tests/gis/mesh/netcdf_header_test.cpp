#include "gis/mesh/netcdf_header.h"

#include <netcdf.h>

#include <gtest/gtest.h>

#include "tests/gis/dem_files.h"
#include "tests/gis/mesh/hill_mesh.h"

namespace arete {
namespace {

/// A variable with attributes of all sizes, one with records, one without dimensions.
void make_file(const std::string& path, int mode) {
  int id = 0, fixed = 0, records = 0, variable = 0;
  ASSERT_EQ(nc_create(path.c_str(), mode, &id), NC_NOERR);
  nc_def_dim(id, "fixed", 3, &fixed);
  nc_def_dim(id, "records", NC_UNLIMITED, &records);
  nc_put_att_text(id, NC_GLOBAL, "title", 5, "abcde");
  const int both[] = {records, fixed};
  nc_def_var(id, "a", NC_DOUBLE, 1, &fixed, &variable);
  const double values[] = {1, 2, 3};
  nc_put_att_double(id, variable, "range", NC_FLOAT, 3, values);
  nc_put_att_double(id, variable, "shorts", NC_SHORT, 3, values);
  nc_def_var(id, "b", NC_INT, 2, both, &variable);
  nc_def_var(id, "c", NC_CHAR, 0, nullptr, &variable);
  nc_enddef(id);
  ASSERT_EQ(nc_close(id), NC_NOERR);
}

TEST(NetcdfHeader, PassesWhatLibnetcdfWrites) {
  const TestFolder folder;
  for (const int mode : {0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4}) {
    make_file(folder / "a.nc", mode | NC_CLOBBER);
    EXPECT_NO_THROW(check_netcdf_header(folder / "a.nc")) << mode;
  }
}

// What passes is opened by libnetcdf without a crash: 4.9.0 crashes on a name of no length, and on counts beyond the file.
TEST(NetcdfHeader, WhatPassesIsSafeToOpen) {
  const TestFolder folder;
  for (const int mode : {0, NC_64BIT_OFFSET, NC_64BIT_DATA}) {
    make_file(folder / "a.nc", mode | NC_CLOBBER);
    const int refused = read_damaged(folder / "a.nc", folder / "bad.nc", 1, [](const std::string& path) {
      check_netcdf_header(path);
      int id = 0;
      if (nc_open(path.c_str(), NC_NOWRITE, &id) == NC_NOERR) nc_close(id);
      return MeshStore();
    });
    EXPECT_GT(refused, 100);
  }
}

}  // namespace
}  // namespace arete
