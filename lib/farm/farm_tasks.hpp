// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace orchard::farm {

/// One drive of one robot in one block, as it lies in the farm's folder.
struct Drive {
  std::string block, date, robot;
  std::string name;                    ///< of its log, without .lcm
  std::vector<std::string> log_paths;  ///< the pieces of the log, in order of their names
  std::string log_digest;              ///< of the pieces' bytes
  std::uint64_t num_bytes = 0;
  std::string rig_path;    ///< empty: the rig that the log carries
  std::string rig_digest;  ///< of that file's bytes; empty as well

  /// "BLOCK/DATE/ROBOT/NAME", for people.
  std::string title() const { return block + "/" + date + "/" + robot + "/" + name; }
};

/// What decides of results besides logs and rigs.
struct FarmSettings {
  bool any_place = false;     ///< drives begin in frames of their own
  double max_offset_m = 5.0;  ///< else: how far apart two drives may place one tree
  std::string version;        ///< of the program
};

enum class TaskKind {
  kCheck,    ///< what is wrong with a log
  kMap,      ///< the map of a drive
  kDate,     ///< the drives of a date joined, ids and numbers of the date before kept
  kChanges,  ///< what changed since the date before
  kReport,   ///< what a grower reads of a date
};

/// "check", "map", "date", "changes", "report".
const char* kind_text(TaskKind kind);

/// One step: what it needs, and the name of its result.
struct FarmTask {
  TaskKind kind = TaskKind::kCheck;
  /// "map-" and a digest of all that decides of the result: nothing is ever computed twice.
  std::string name;
  std::vector<std::string> needs;    ///< names of tasks: what is mapped, joined or compared
  std::vector<std::string> earlier;  ///< of a date or changes: the dates before, the oldest first
  std::vector<Drive> drives;         ///< of which it is; alike ones have one result
};

/// What people have changed by hand in the result of a date, as a digest; empty: nothing.
using EditsOf = std::function<std::string(const std::string& name)>;

/// All steps of a farm, each after those that it needs: checks, maps, and date by date for each
/// block. A pure function of its arguments: the order of `drives` does not matter. What was edited
/// on a date decides of the next one, too.
std::vector<FarmTask> tasks_of(std::vector<Drive> drives, const FarmSettings& settings,
                               const EditsOf& edits_of = {});

}  // namespace orchard::farm
