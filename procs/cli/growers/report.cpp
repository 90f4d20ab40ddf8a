// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "bus/process/process.hpp"
#include "cli/growers/report.hpp"
#include "cli/maps/stored_maps.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/report/map_report.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

io::EarlierMap compared_with(const ReportOptions& options, const MapInput& now) {
  ComparedMaps compared =
      compare_with_earlier("orchard report", options.previous_path, options.map_path, now,
                           options.as_mapped, options.alignment);
  return {map_name(options.previous_path), facts_of(options.previous_path).day,
          std::move(compared.before.map.landmarks), std::move(compared.comparison)};
}

/// The values of report.csv as JSON; `row` is its number or name, "all" for the totals.
nlohmann::ordered_json json_of(const std::vector<std::vector<std::string>>& table,
                               const fs::path& folder) {
  using Json = nlohmann::ordered_json;
  Json rows = Json::array();
  for (std::size_t i = 1; i < table.size(); ++i) {
    Json row;
    for (std::size_t k = 0; k < table.front().size(); ++k) {
      const std::string& name = table.front()[k];
      const std::string& cell = table[i].at(k);
      if (name == "row" && !whole_number(cell)) {
        row[name] = cell;
      } else if (name == "empty_positions") {
        row[name] = Json::array();
        std::istringstream positions(cell);
        for (std::int32_t position; positions >> position;) row[name].push_back(position);
      } else {
        row[name] = cell.empty() ? Json() : Json::parse(cell);
      }
    }
    rows.push_back(std::move(row));
  }
  return Json{{"folder", folder.string()},
              {"files", {"report.html", "report.csv"}},
              {"rows", std::move(rows)}};
}

}  // namespace

int write_report(const ReportOptions& options, const PlanLayer& planned) {
  const io::ReportTexts* texts = io::find_report_texts(options.language);
  if (texts == nullptr) {
    throw io::FileError("--language " + options.language + ": unknown language; choose en or es");
  }
  io::ReportContent content;
  const MapInput input = read_map_input("orchard report", options.map_path, options.as_mapped);
  content.map = input.map;
  content.row_names = input.row_names;
  content.name = options.name.empty() ? map_name(options.map_path) : printable_text(options.name);
  content.facts = facts_of(options.map_path);
  if (!options.previous_path.empty()) content.earlier = compared_with(options, input);
  if (!options.plan_path.empty()) content.plan = planned(content.map);

  const fs::path folder = options.out_folder.empty() ? map_folder_of(options.map_path) / "report"
                                                     : fs::path(options.out_folder);
  io::make_folder(folder.string(), "choose another folder with --out");
  io::FileReplacement files;
  files.write((folder / "report.html").string(), io::map_report(content, *texts));
  const std::vector<std::vector<std::string>> table = io::report_table(content);
  files.write((folder / "report.csv").string(), io::report_csv(table));
  files.commit();
  if (options.json) {
    std::printf("%s\n", json_of(table, folder).dump(1).c_str());
    return bus::kExitOk;
  }
  std::printf("written to %s: report.html (to read and print), report.csv (rows)\n",
              folder.string().c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
