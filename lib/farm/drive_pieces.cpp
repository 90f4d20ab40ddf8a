// SPDX-License-Identifier: BSD-3-Clause
#include "farm/drive_pieces.hpp"

#include <map>
#include <optional>
#include <regex>
#include <set>
#include <utility>

namespace orchard::farm {
namespace {

struct LogName {
  std::string drive;
  bool is_recorders = false;  ///< a piece of LogRecorder
  int number = -1;            ///< of the piece; -1: the whole log
};

/// Numbers have as many digits as a recording of thousands of pieces needs; with more, such as in
/// north-20260430.lcm, they are no pieces.
std::optional<LogName> log_name(const std::string& file) {
  static const std::regex kWhole("(.+)\\.lcm(?:\\.([0-9]{1,4}))?");
  static const std::regex kRecorders("(.+)-([0-9]{3}|[1-9][0-9]{3})\\.lcm");
  std::smatch match;
  if (std::regex_match(file, match, kRecorders))
    return LogName{match[1], true, std::stoi(match[2])};
  if (!std::regex_match(file, match, kWhole)) return std::nullopt;
  return LogName{match[1], false, match[2].matched ? std::stoi(match[2]) : -1};
}

void add_range(int from, int to, std::string& text) {
  if (from > to) return;
  text += (text.empty() ? "" : ", ") + std::to_string(from);
  if (to > from) text += "-" + std::to_string(to);
}

using NumberedFiles = std::set<std::pair<int, std::string>>;

std::string missing_in(const NumberedFiles& pieces) {
  std::string missing;
  int next = 0;
  for (const auto& [number, file] : pieces) {
    add_range(next, number - 1, missing);
    next = number + 1;
  }
  return missing;
}

DrivePieces drive_of(const std::string& name, bool is_recorders, const NumberedFiles& pieces) {
  DrivePieces drive{name, {}, missing_in(pieces)};
  for (const auto& [number, file] : pieces) drive.files.push_back(file);
  const auto& [first_number, first_file] = *pieces.begin();
  if (is_recorders && pieces.size() == 1 && first_number != 0) {
    return {first_file.substr(0, first_file.size() - std::string(".lcm").size()), {first_file}, {}};
  }
  return drive;
}

}  // namespace

bool is_log_name(const std::string& file) { return log_name(file).has_value(); }

std::vector<DrivePieces> drives_of_files(const std::vector<std::string>& files) {
  std::map<std::pair<std::string, bool>, NumberedFiles> pieces;
  for (const std::string& file : files) {
    const auto name = log_name(file);
    if (name) pieces[{name->drive, name->is_recorders}].emplace(name->number, file);
  }
  std::vector<DrivePieces> drives;
  for (const auto& [of, by_number] : pieces) {
    drives.push_back(drive_of(of.first, of.second, by_number));
  }
  return drives;
}

}  // namespace orchard::farm
