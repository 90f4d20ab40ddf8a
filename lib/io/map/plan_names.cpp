// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/plan_names.hpp"

#include "io/csv.hpp"
#include "io/file_error.hpp"
#include "mapping/plan/orchard_plan.hpp"

namespace orchard::io {

std::string plan_names_csv(const mapping::PlanNames& names) {
  std::string text = "id,row,tree\n";
  for (const auto& [id, name] : names) {
    text += std::to_string(id) + "," + csv_field(name.row) + "," + csv_field(name.tree) + "\n";
  }
  return text;
}

mapping::PlanNames read_plan_names(const std::string& path) {
  CsvReader csv = CsvReader::open_quoted(path);
  csv.expect_columns({"id", "row", "tree"});
  mapping::PlanNames names;
  while (csv.next()) {
    const std::int32_t id = mapping::number_in_name(std::string(csv.text(0)));
    if (id == 0) csv.fail(0, "must be a number from 1");
    const mapping::PlanName name{std::string(csv.text(1)), std::string(csv.text(2))};
    if (!names.emplace(id, name).second) csv.fail(0, "occurs twice");
  }
  if (names.empty()) throw FileError(path + " names nothing; run `orchard plan` again");
  return names;
}

}  // namespace orchard::io
