// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/plan_names.hpp"

#include <fstream>

#include "io/csv.hpp"
#include "io/file_error.hpp"
#include "mapping/plan/orchard_plan.hpp"

namespace orchard::io {
namespace {

constexpr char kHeader[] = "id,row,tree";

/// Splits a line into fields; empty if its quotes are not closed.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields{""};
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  if (is_quoted) fields.clear();
  return fields;
}

}  // namespace

std::string plan_names_csv(const mapping::PlanNames& names) {
  std::string text = std::string(kHeader) + "\n";
  for (const auto& [id, name] : names) {
    text += std::to_string(id) + "," + csv_field(name.row) + "," + csv_field(name.tree) + "\n";
  }
  return text;
}

mapping::PlanNames read_plan_names(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  mapping::PlanNames names;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string at = path + ":" + std::to_string(number) + ": ";
    if (number == 1) {
      if (line != kHeader) throw FileError(at + "must be " + kHeader);
      continue;
    }
    std::vector<std::string> fields = fields_of(line);
    const std::int32_t id = fields.size() == 3 ? mapping::number_in_name(fields[0]) : 0;
    if (id == 0 || line.size() > 1000) throw FileError(at + "must be id,row,tree");
    if (!names.emplace(id, mapping::PlanName{fields[1], fields[2]}).second) {
      throw FileError(at + "id " + fields[0] + " occurs twice");
    }
  }
  if (names.empty()) throw FileError(path + " cannot be read, or is empty");
  return names;
}

}  // namespace orchard::io
