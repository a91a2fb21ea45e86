#pragma once

#include <string>

namespace arete {

/// Checks the header of a NetCDF file of the classic kinds (CDF-1, CDF-2, CDF-5) before libnetcdf opens it: version 4.9.0 of that
/// crashes on damaged ones. Names are not empty, lists and values end within the file, dimensions that are named exist, and the
/// values of every variable without records lie within the file. Other files (NetCDF-4) pass. Throws Error{input} that says where.
void check_netcdf_header(const std::string& path);

}  // namespace arete
