// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bus/process/process.hpp"
#include "cli/growers/edit.hpp"
#include "cli/maps/map_registration.hpp"
#include "cli/maps/stored_content.hpp"
#include "detection/detection.hpp"
#include "io/map/corrections_file.hpp"
#include "mapping/corrections/apply_corrections.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

using mapping::Correction;
using mapping::CorrectionOutcome;

void print(const io::CorrectedMapFolder& map, bool only_conflicts, bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < map.corrections.size(); ++i) {
    const Correction& c = map.corrections[i];
    const mapping::CorrectionResult& result = map.corrected.results[i];
    if (only_conflicts && result.outcome != CorrectionOutcome::kConflict) continue;
    if (json) {
      auto entry = nlohmann::ordered_json::parse(io::correction_line(c));
      entry["outcome"] = mapping::outcome_word(result.outcome);
      if (!result.reason.empty()) entry["reason"] = result.reason;
      list.push_back(std::move(entry));
      continue;
    }
    const std::string more = (c.note.empty() ? "" : "  " + c.note) +
                             (result.reason.empty() ? "" : "  [" + result.reason + "]");
    std::printf("%4d  %s  %-12s  %-10s  %s%s\n", c.number, io::utc_text(c.utime).c_str(),
                printable_text(c.who).c_str(), mapping::outcome_word(result.outcome),
                printable_text(mapping::correction_words(c)).c_str(), printable_text(more).c_str());
  }
  if (json) std::printf("%s\n", list.dump(1).c_str());
}

}  // namespace

int run_edit_list(const EditOptions& options) {
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_folder);
  print(map, false, options.json);
  if (!options.json) std::printf("%s\n", io::corrections_text(map.corrected).c_str());
  return bus::kExitOk;
}

int run_edit_check(const EditOptions& options) {
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_folder);
  print(map, true, options.json);
  if (!options.json) std::printf("%s\n", io::corrections_text(map.corrected).c_str());
  const bool is_sound = map.corrected.count(CorrectionOutcome::kConflict) == 0;
  return is_sound && map.num_unfinished_bytes == 0 ? bus::kExitOk : bus::kExitInput;
}

int run_edit_apply(const EditOptions& options) {
  require_other_folder(options.out_folder, {options.map_folder});
  const io::CorrectedMapFolder map = io::read_corrected_map(options.map_folder);
  io::StoredMap known = map.mapped;
  known.landmarks = map.corrected.landmarks;
  known.next_id = map.corrected.next_id;
  io::MapFolderContent content = content_of(known);
  content.rows = map.rows;
  content.graph = map.graph;
  content.summary.source = "corrected";
  content.summary.counts = {{"corrections", static_cast<std::int64_t>(map.corrections.size())}};
  for (const mapping::CorrectionResult& result : map.corrected.results) {
    if (result.outcome != CorrectionOutcome::kConflict) continue;
    content.summary.warnings.push_back("correction " + std::to_string(result.number) +
                                       " conflicts with the map: " + result.reason);
  }
  io::write_map_folder(options.out_folder, content);
  std::printf("%zu landmarks, corrections %s, written to %s\n", content.landmarks.size(),
              io::corrections_text(map.corrected).c_str(), options.out_folder.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
