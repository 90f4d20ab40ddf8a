// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::farm {

/// SHA-256 digest of bytes added in pieces, by OpenSSL's libcrypto. Throws std::runtime_error when
/// that refuses (a system whose policy has no SHA-256).
class Sha256 {
 public:
  Sha256();
  void add(const void* bytes, std::size_t size);

  /// Returns the digest of all bytes added, as 64 hexadecimal digits. Nothing may be added
  /// afterwards.
  std::string hex();

 private:
  std::shared_ptr<void> context_;
};

/// SHA-256 digest of a text.
std::string sha256_hex(std::string_view text);

inline constexpr std::size_t kNameDigits = 20;  ///< of a name; 1e9 results hardly collide

/// One drive of one robot in one block, as found in the farm's folder.
struct Drive {
  std::string block, date, robot;
  std::string name;                    ///< log name without .lcm
  std::vector<std::string> log_paths;  ///< pieces of the log, in order of their names
  std::string log_digest;              ///< of the bytes of all pieces
  std::uint64_t num_bytes = 0;
  std::string rig_path;    ///< of the rig's copy; empty: the rig in the log
  std::string rig_digest;  ///< of what the rig means and of the files that it names
  /// Every file that the map is made of, with its SHA-256; empty: it is not there.
  std::map<std::string, std::string> files;
  double max_offset_m = kMaxOffset_m;  ///< between two maps, as its pose mode warrants

  static constexpr double kMaxOffset_m = 5.0;  ///< physical: of GNSS on two days
  /// physical: of fixes, which are surveyed; a row is farther away.
  static constexpr double kMaxOffsetOfFixes_m = 0.5;

  /// "BLOCK/DATE/ROBOT/NAME", for display.
  std::string title() const { return block + "/" + date + "/" + robot + "/" + name; }
};

/// Settings that affect the results, besides logs and rigs.
struct FarmSettings {
  bool any_place = false;  ///< drives begin in frames of their own
  /// Else: max distance between one tree's positions in two drives; none: as the drives warrant.
  std::optional<double> max_offset_m;
  std::string version;     ///< identity of the programs that make the results
  std::string publish_to;  ///< URL of the database of all blocks; empty if there is none
};

enum class TaskKind {
  kMap,      ///< map of a drive
  kDate,     ///< merged drives of a date, with the ids and numbers of the previous date
  kChanges,  ///< changes since the previous date
  kReport,   ///< grower's report of a date
  kPublish,  ///< date's map in the database of all blocks
};

/// "map", "date", "changes", "report", "publish".
const char* kind_text(TaskKind kind);

/// One step: its inputs and the name of its result.
struct FarmTask {
  TaskKind kind = TaskKind::kMap;
  /// Kind and a digest of everything that affects the result ("map-..."), so that no result is
  /// computed twice.
  std::string name;
  std::vector<std::string> needs;    ///< names of tasks: what is mapped, merged or compared
  std::vector<std::string> earlier;  ///< date, changes: the previous dates, oldest first
  std::vector<Drive> drives;         ///< drives of the task; identical ones share one result
  double max_offset_m = 0.0;         ///< date, changes: between two maps
  std::map<std::string, std::string> edits{};  ///< of dates: the manual edits that must be found

  /// Of a map the title of its drive, else "BLOCK/DATE", for display.
  std::string title() const {
    const Drive& drive = drives.front();
    return kind == TaskKind::kMap ? drive.title() : drive.block + "/" + drive.date;
  }
};

/// Digest of the manual edits in the result of a date; empty if there are none.
using EditsOf = std::function<std::string(const std::string& name)>;

/// Lists all steps of a farm, each after the steps that it needs: maps, and for each block date by
/// date. A pure function of its arguments; the order of `drives` does not matter. Edits of
/// a date also affect the next one.
std::vector<FarmTask> tasks_of(std::vector<Drive> drives, const FarmSettings& settings,
                               const EditsOf& edits_of = {});

}  // namespace orchard::farm
