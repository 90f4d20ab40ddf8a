// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "farm/cost_fit.hpp"
#include "farm/farm_tasks.hpp"

namespace orchard::cli {

/// What became of a step.
struct TaskState {
  bool is_good = false;
  std::string reason;  ///< why it was set aside; empty when it is good
};

/// What a farm's folder holds of the user's: logs, rigs, settings.
struct FarmContent {
  std::vector<farm::Drive> drives;
  farm::FarmSettings settings;
  std::vector<std::string> notes;  ///< files below logs/ that are no drive, one sentence each
};

/// A farm: logs/BLOCK/DATE/ROBOT/NAME.lcm (pieces: NAME.lcm.00 ...), rigs/ROBOT.yaml, farm.yaml;
/// results/ by their names, maps/ by block and date, work/ what is needed on the way.
class FarmFolder {
 public:
  /// Throws io::FileError when `root` is no farm.
  explicit FarmFolder(std::string root);

  const std::string& root() const { return root_; }
  std::string path(const std::string& inside) const { return root_ + "/" + inside; }

  /// Reads what lies there; the digest of a log that has not changed (size, time) is not computed
  /// again. Throws io::FileError for names that are no plain words and for a bad farm.yaml.
  FarmContent read() const;

  /// The steps that `content` asks for; what was edited by hand decides of the dates after it.
  std::vector<farm::FarmTask> tasks_of(const FarmContent& content) const;

  /// Digest of a result's corrections where they are not those that it was made with; else empty.
  std::string edits_of(const std::string& task) const;

  /// Writes work/tasks.json, what the Snakefile goes by.
  void write_tasks(const FarmContent& content, const std::vector<farm::FarmTask>& tasks,
                   const farm::CostFit& costs) const;

  /// None: it is still to be made.
  std::optional<TaskState> state_of(const std::string& task) const;

  /// What every map that is still there has cost, in order of their names.
  std::vector<farm::CostSample> costs(const std::vector<farm::FarmTask>& tasks) const;

 private:
  std::string root_;
};

/// Line of a state.txt: the corrections that a result was made with, carried from the date before.
/// Empty: `folder` has none.
std::string corrections_line(const std::string& folder);

/// A word of a farm's paths: letters, digits, ".", "-" and "_", not beginning with "." or "-".
bool is_farm_word(const std::string& word);

/// SHA-256 of the bytes of files, one after the other. Throws io::FileError.
std::string digest_of_files(const std::vector<std::string>& paths);

}  // namespace orchard::cli
