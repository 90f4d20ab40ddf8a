// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/logs/log_survey.hpp"

namespace orchard::cli {

/// Content and faults of a log as JSON; times in seconds, ends with a newline.
std::string log_json(const std::string& path, const LogSurvey& survey);

}  // namespace orchard::cli
