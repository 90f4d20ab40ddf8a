// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bus/node/process.hpp"
#include "cli/growers/edit.hpp"
#include "cli/maps/map_laying.hpp"
#include "cli/maps/stored_content.hpp"
#include "detection/label_text.hpp"
#include "io/map/corrections_file.hpp"
#include "text/number_text.hpp"
#include "text/printable_text.hpp"

namespace orchard::cli {
namespace {

using mapping::Correction;
using mapping::CorrectionOutcome;

const char* outcome_word(CorrectionOutcome outcome) {
  switch (outcome) {
    case CorrectionOutcome::kApplied:
      return "applied";
    case CorrectionOutcome::kByPlace:
      return "by place";
    case CorrectionOutcome::kSatisfied:
      return "already so";
    case CorrectionOutcome::kConflict:
      return "CONFLICT";
    case CorrectionOutcome::kUndone:
      break;
  }
  return "undone";
}

std::string words_of(const Correction& c) {
  std::string words = mapping::correction_word(c.kind);
  for (const auto& target : c.targets) words += " " + std::to_string(target.id);
  if (c.of != 0) words += " " + std::to_string(c.of);
  if (c.kind == mapping::CorrectionKind::kAdd) words += " " + std::to_string(c.new_id);
  if (c.kind == mapping::CorrectionKind::kClass) words += std::string(" ") + label_text(c.label);
  const bool is_row = c.kind == mapping::CorrectionKind::kRowName;
  if (c.row != 0) words += (is_row ? " " : " row ") + std::to_string(c.row);
  if (c.position != 0) words += " tree " + std::to_string(c.position);
  if (!c.name.empty()) words += " \"" + c.name + "\"";
  for (const auto& p : c.places_map) {
    words += " at " + fixed_text(p.x(), 2) + " " + fixed_text(p.y(), 2);
  }
  return words;
}

void print(const io::CorrectedMapFolder& map, bool only_conflicts, bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < map.corrections.size(); ++i) {
    const Correction& c = map.corrections[i];
    const mapping::CorrectionResult& result = map.corrected.results[i];
    if (only_conflicts && result.outcome != CorrectionOutcome::kConflict) continue;
    if (json) {
      auto entry = nlohmann::ordered_json::parse(io::correction_line(c));
      entry["outcome"] = outcome_word(result.outcome);
      if (!result.reason.empty()) entry["reason"] = result.reason;
      list.push_back(std::move(entry));
      continue;
    }
    const std::string more = (c.note.empty() ? "" : "  " + c.note) +
                             (result.reason.empty() ? "" : "  [" + result.reason + "]");
    std::printf("%4d  %s  %-12s  %-10s  %s%s\n", c.number, io::utc_text(c.utime).c_str(),
                printable_text(c.who).c_str(), outcome_word(result.outcome),
                printable_text(words_of(c)).c_str(), printable_text(more).c_str());
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
  content.summary.source = "corrected";
  content.summary.counts = {{"corrections", static_cast<std::int64_t>(map.corrections.size())}};
  for (const mapping::CorrectionResult& result : map.corrected.results) {
    if (result.outcome != CorrectionOutcome::kConflict) continue;
    content.summary.warnings.push_back("correction " + std::to_string(result.number) +
                                       " is in conflict: " + result.reason);
  }
  io::write_map_folder(options.out_folder, content);
  std::printf("%zu landmarks, corrections %s, written to %s\n", content.landmarks.size(),
              io::corrections_text(map.corrected).c_str(), options.out_folder.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
