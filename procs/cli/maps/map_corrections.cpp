// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/map_corrections.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

using mapping::Correction;
using mapping::CorrectionOutcome;

bool are_the_same(const Correction& a, const Correction& b) {
  return a.number == b.number && a.utime == b.utime && a.who == b.who && a.kind == b.kind &&
         a.note == b.note;
}

}  // namespace

void require_corrections_of(const std::string& out_folder, const io::CorrectedMapFolder& earlier) {
  for (const Correction& c : io::read_corrections(out_folder).list) {
    const bool is_known =
        std::any_of(earlier.corrections.begin(), earlier.corrections.end(),
                    [&](const Correction& known) { return are_the_same(known, c); });
    if (is_known) continue;
    throw io::FileError(out_folder + "/" + io::kCorrectionsFile + " has correction " +
                        std::to_string(c.number) + " by " + c.who + ", which is not in the map " +
                        earlier.mapped.name + "; choose another folder with --out");
  }
}

std::string account_corrections(const char* command, const std::vector<Correction>& corrections,
                                io::MapFolderContent& content) {
  if (corrections.empty()) return {};
  const mapping::CorrectedMap corrected =
      mapping::apply_corrections(content.landmarks, content.next_id, corrections);
  content.next_id = std::max(content.next_id, corrected.next_id);
  const auto count = [&](const char* name, CorrectionOutcome outcome) {
    content.summary.counts.push_back({kCorrectionCount + name, corrected.count(outcome)});
  };
  count("applied", CorrectionOutcome::kApplied);
  count("by_place", CorrectionOutcome::kByPlace);
  count("already_so", CorrectionOutcome::kSatisfied);
  count("in_conflict", CorrectionOutcome::kConflict);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    if (corrected.results[i].outcome != CorrectionOutcome::kConflict) continue;
    const Correction& c = corrections[i];
    content.summary.warnings.push_back("correction " + std::to_string(c.number) + " (" +
                                       mapping::correction_word(c.kind) + ", by " + c.who +
                                       ") conflicts with the map: " + corrected.results[i].reason);
    std::fprintf(stderr, "%s: warning: %s\n", command, content.summary.warnings.back().c_str());
  }
  return io::corrections_text(corrected);
}

void write_corrections(const std::string& folder, const std::vector<Correction>& corrections) {
  const std::string path = folder + "/" + io::kCorrectionsFile;
  if (corrections.empty()) return;
  std::string text;
  for (const Correction& c : corrections) text += io::correction_line(c);
  io::write_file_atomically(path, text);
}

}  // namespace orchard::cli
