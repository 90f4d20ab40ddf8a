// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "farm/farm_tasks.hpp"
#include "farm/step_lots.hpp"

namespace orchard::cli {

/// State of a finished step.
struct TaskState {
  bool is_good = false;
  std::string reason;                        ///< why it was set aside; empty if it is good
  std::string corrections;                   ///< corrections_line() when it was made
  std::map<std::string, std::string> files;  ///< of the result, with their SHA-256
};

/// What makes results: the files as identity_of() tells them, and the digest of their bytes.
struct Programs {
  std::string identity, digest;
};

/// The user's files in a farm's folder: logs, rigs, settings.
struct FarmContent {
  std::vector<farm::Drive> drives;
  farm::FarmSettings settings;
  std::vector<std::string> notes;  ///< files below logs/ that are no drives, one sentence each
  std::map<std::string, std::string> rig_copies;  ///< by the path that the steps read
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

  /// Reads the folder, which needs no write access. Digests of unchanged logs are taken from a
  /// cache. The version is that of the last adopt_programs(), whether or not the programs have
  /// changed since, which gives a note. What is no drive, such as a name that cannot be used or a
  /// date that is none, gives a note. Throws io::FileError for an invalid farm.yaml.
  FarmContent read() const;

  /// Names results from now on by the programs of this installation and the farm's Snakefile: what
  /// others have made is made anew. `keep_others`: only where none have been adopted yet. Throws
  /// io::FileError.
  void adopt_programs(bool keep_others) const;

  /// The steps required for `content`. Corrections by hand are inputs of the later dates.
  std::vector<farm::FarmTask> tasks_of(const FarmContent& content) const;

  /// Identifies the corrections of a result if they have changed since it was computed; otherwise
  /// empty.
  std::string edits_of(const std::string& task) const;

  /// State of a step; none if it is not finished.
  std::optional<TaskState> state_of(const std::string& task) const;

  /// Whether a step is finished, good or set aside.
  bool is_made(const std::string& task) const;

  /// What is altered or missing in the files of a result; empty: nothing.
  std::string damage_of(const std::string& task) const;

  /// Names of results and of what unfinished steps left (".making-...").
  std::vector<std::string> result_names() const;

  /// Costs of the kinds of steps, fitted to what the steps took.
  farm::StepCosts costs(const std::vector<farm::FarmTask>& tasks) const;

  /// Puts what steps took into one file, so that the next run opens one. Throws io::SystemError.
  void gather_costs() const;

  /// Digest of the bytes of all that makes a result: the programs that the steps call, and the
  /// Snakefile. Computed anew where one of these files is another.
  Programs programs() const;

  /// Takes a digest as known where the files are those that it was computed of.
  void know_programs(const Programs& known) const { programs_ = known; }

 private:
  std::string root_;
  mutable Programs programs_;
};

/// Allows one run at a time, of `farm run` or of what removes results.
class RunLock {
 public:
  /// Throws io::FileError while another process holds it.
  explicit RunLock(const FarmFolder& farm);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  int fd_;
};

/// Removes the temporary folders of steps that were killed on this machine; `of_others`: and those
/// of steps on other machines, none of which may be running.
void remove_unfinished(const FarmFolder& farm, bool of_others);

/// Line of a state.txt that identifies the corrections in `folder`, such as those carried over from
/// the previous date; empty if there are none.
std::string corrections_line(const std::string& folder);

/// What the Snakefile reads: the lots of both phases, "maps" and "others", with steps and costs.
inline constexpr const char* kLotsFile = "work/lots.json";

/// Begins the line at the end of a step's standard error that says why it failed.
inline constexpr const char* kFailedWord = "failed: ";

/// The status of a farm as text or JSON.
std::string status_text(const FarmFolder& farm, const FarmContent& content,
                        const std::vector<farm::FarmTask>& tasks, bool json);

/// Prints the notes of a farm's content on stderr.
void print_notes(const char* command, const FarmContent& content);

/// What the user has put into a farm, without version. Throws io::FileError.
FarmContent read_content(const FarmFolder& farm);

/// Why a name cannot be that of a block, a robot or a log; empty: it can.
std::string name_problem(const std::string& name);

/// The last line of a file that is not empty; empty: none.
std::string last_line(const std::string& path);

/// Size, inode and time of change of a file. Throws io::SystemError.
std::string identity_of(const std::string& path);

/// SHA-256 of the concatenated bytes of files. Throws io::SystemError.
std::string digest_of_files(const std::vector<std::string>& paths);

}  // namespace orchard::cli
