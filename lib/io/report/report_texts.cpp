// SPDX-License-Identifier: BSD-3-Clause
#include "io/report/report_texts.hpp"

namespace orchard::io {

const ReportTexts* find_report_texts(const std::string& language) {
  for (const ReportTexts* texts : {&kReportTextsEn, &kReportTextsEs}) {
    if (language == texts->language) return texts;
  }
  return nullptr;
}

}  // namespace orchard::io
