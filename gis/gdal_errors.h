#pragma once

#include <string>

#include <cpl_error.h>

namespace arete {

/// While it lives, GDAL's messages of this thread are kept here instead of printed. Registers GDAL's drivers at first use.
/// For the sources of gis/ only: its header includes GDAL's.
class GdalErrors {
 public:
  GdalErrors();
  ~GdalErrors();
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  bool failed() const { return failed_; }
  CPLErrorNum number() const { return number_; }
  /// The first failure in one line, or the first warning where nothing failed; empty where there was none.
  const std::string& message() const { return message_; }
  /// ": message", or nothing: to end a sentence with.
  std::string suffix() const { return message_.empty() ? "" : ": " + message_; }

 private:
  static void CPL_STDCALL keep(CPLErr severity, CPLErrorNum number, const char* text);

  bool failed_ = false;
  CPLErrorNum number_ = CPLE_None;
  std::string message_;
};

}  // namespace arete
