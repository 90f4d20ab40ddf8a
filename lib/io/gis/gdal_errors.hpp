// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cpl_error.h>

#include <string>

namespace orchard::io {

/// Collects GDAL's error messages of this thread during its lifetime instead of printing them.
class GdalErrors {
 public:
  GdalErrors() { CPLPushErrorHandlerEx(&GdalErrors::handle, this); }
  ~GdalErrors() { CPLPopErrorHandler(); }
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  /// First failure; empty if there is none.
  const std::string& first() const { return first_; }

 private:
  static void CPL_STDCALL handle(CPLErr level, CPLErrorNum, const char* message) {
    auto* self = static_cast<GdalErrors*>(CPLGetErrorHandlerUserData());
    if (level >= CE_Failure && self->first_.empty()) self->first_ = message;
  }
  std::string first_;
};

}  // namespace orchard::io
