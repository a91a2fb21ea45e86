#include "gis/gdal_errors.h"

#include <mutex>

#include <gdal.h>

namespace arete {

GdalErrors::GdalErrors() {
  static std::once_flag registered;
  CPLPushErrorHandlerEx(keep, this);
  CPLSetCurrentErrorHandlerCatchDebug(FALSE);
  std::call_once(registered, GDALAllRegister);
}

GdalErrors::~GdalErrors() {
  CPLPopErrorHandler();
  CPLErrorReset();
}

void CPL_STDCALL GdalErrors::keep(CPLErr severity, CPLErrorNum number, const char* text) {
  if (severity < CE_Warning) return;
  auto* errors = static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
  const bool failure = severity >= CE_Failure;
  if (errors->failed_ || (!failure && !errors->message_.empty())) return;
  errors->failed_ = failure;
  errors->number_ = number;
  errors->message_.clear();
  for (const char* c = text; *c != '\0'; ++c) {
    const bool space = *c == '\n' || *c == '\r' || *c == ' ';
    if (!space)
      errors->message_ += *c;
    else if (!errors->message_.empty() && errors->message_.back() != ' ')
      errors->message_ += ' ';
  }
  while (!errors->message_.empty() && (errors->message_.back() == ' ' || errors->message_.back() == '.')) errors->message_.pop_back();
}

}  // namespace arete
