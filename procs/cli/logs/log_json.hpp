// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/logs/log_survey.hpp"

namespace orchard::cli {

/// What a log holds and what is wrong with it, for programs; times in seconds, ends with a newline.
std::string log_json(const std::string& path, const LogSurvey& survey);

}  // namespace orchard::cli
