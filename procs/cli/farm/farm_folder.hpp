// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "farm/cost_fit.hpp"
#include "farm/farm_tasks.hpp"

namespace orchard::cli {

/// State of a finished step.
struct TaskState {
  bool is_good = false;
  std::string reason;  ///< why it was set aside; empty if it is good
};

/// The user's files in a farm's folder: logs, rigs, settings.
struct FarmContent {
  std::vector<farm::Drive> drives;
  farm::FarmSettings settings;
  std::vector<std::string> notes;  ///< files below logs/ that are no drives, one sentence each
};

/// The folder of a farm: logs/BLOCK/DATE/ROBOT/NAME.lcm (pieces: NAME-000.lcm ... or NAME.lcm.00
/// ...), rigs/ROBOT.yaml, farm.yaml; results/ by name, maps/ by block and date, intermediate files
/// in work/.
class FarmFolder {
 public:
  /// Throws io::FileError when `root` is not a farm.
  explicit FarmFolder(std::string root);

  const std::string& root() const { return root_; }
  std::string path(const std::string& inside) const { return root_ + "/" + inside; }

  /// Reads the folder. Digests of unchanged logs (same size and time) are taken from a cache.
  /// The version is that of the last adopt_programs(), whether or not the programs have changed
  /// since, which gives a note. What is no drive, such as a name that cannot be used or a date that
  /// is none, gives a note. Throws io::FileError for an invalid farm.yaml.
  FarmContent read() const;

  /// Names results from now on by the programs of this installation and the farm's Snakefile: what
  /// others have made is made anew. `keep_others`: only where none have been adopted yet. Throws
  /// io::FileError.
  void adopt_programs(bool keep_others) const;

  /// The steps required for `content`. Corrections by hand are inputs of the later dates.
  std::vector<farm::FarmTask> tasks_of(const FarmContent& content) const;

  /// corrections_line() of a result if its corrections have changed since it was computed;
  /// otherwise empty.
  std::string edits_of(const std::string& task) const;

  /// Writes work/tasks.json, the input of the Snakefile.
  void write_tasks(const FarmContent& content, const std::vector<farm::FarmTask>& tasks,
                   const farm::CostFit& costs) const;

  /// State of a step; none if it is not finished.
  std::optional<TaskState> state_of(const std::string& task) const;

  /// Cost samples of all good maps, in the order of `tasks`.
  std::vector<farm::CostSample> costs(const std::vector<farm::FarmTask>& tasks) const;

 private:
  std::string programs() const;
  std::string root_;
};

/// Line of a state.txt that identifies the corrections in `folder`, such as those carried over from
/// the previous date; empty if there are none.
std::string corrections_line(const std::string& folder);

/// SHA-256 of the concatenated bytes of files. Throws io::FileError.
std::string digest_of_files(const std::vector<std::string>& paths);

}  // namespace orchard::cli
